//! Trackers whose columns are in another convention, and compliances without a load: named, not fitted.

use haptical_calibration::{Calibration, CalibrationError, HeldOut, Options, calibrate, check_rig};
use haptical_model::kinematics::nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use haptical_model::{Body, Device, JointCompliance, Placement, Recording};

use crate::rig_scene::{placement, plain, readings, table, tracked, unknown_tracker};

const JOINTS: usize = 5;

fn device(is_known: bool) -> Device {
    let mut device = table(JOINTS);
    unknown_tracker(&mut device);
    let tracker = device.tracker.as_mut().unwrap();
    (tracker.base_known, tracker.tool_known) = (is_known, is_known);
    device
}

/// What the tracker sees, and of orientations whether it is asked.
fn seen(device: &Device, has_orientations: bool) -> Recording {
    let mut truth = device.clone();
    let is_known = truth.tracker.unwrap().base_known;
    let place = |seed: u64, reach_m: f64| match is_known {
        true => Placement::default(),
        false => placement(seed, reach_m, 0.0),
    };
    truth.surroundings.tracker_base = Some(place(5, 1.0));
    truth.surroundings.tracker_tool = Some(place(6, 0.1));
    // a device as built
    truth.links[1].a_m += 2e-3;
    truth.links[3].alpha_rad += 4e-3;
    let mut recording = plain(readings(&truth, 60, 1.5, 3));
    tracked(&truth, &mut recording, 1.0, 9);
    if !has_orientations {
        recording.orientation_wxyz = None;
    }
    recording
}

fn said(device: &Device, recording: &Recording) -> String {
    match check_rig(device, recording).unwrap_err() {
        CalibrationError::MistakenLog { what, mend, .. } => format!("{what}; {mend}"),
        other => panic!("{other}"),
    }
}

#[test]
fn left_handed_positions_are_named() {
    for has_orientations in [false, true] {
        let unknown = device(false);
        let right = seen(&unknown, has_orientations);
        check_rig(&unknown, &right).unwrap();
        let mut flipped = right.clone();
        flipped.position_m.as_mut().unwrap()[1]
            .iter_mut()
            .for_each(|y| *y = -*y);
        let mut swapped = right;
        swapped.position_m.as_mut().unwrap().swap(0, 1);
        // orientations that are right tell one mirror from another
        let of_one = ["`y_m` negated; ", "`x_m` and `y_m` swapped; "];
        let of_all = "the tracker's axes mirrored, which are left-handed";
        for (wrong, of_one) in [flipped, swapped].into_iter().zip(of_one) {
            let said = said(&unknown, &wrong);
            let expected = if has_orientations { of_one } else { of_all };
            assert!(said.starts_with(expected), "{said}");
        }
    }
    let known = device(true);
    let mut swapped = seen(&known, false);
    check_rig(&known, &swapped).unwrap();
    swapped.position_m.as_mut().unwrap().swap(0, 2);
    let words = said(&known, &swapped);
    assert!(words.starts_with("`x_m` and `z_m` swapped; "), "{words}");
    swapped.position_m.as_mut().unwrap().swap(0, 2);
    let z = &mut swapped.position_m.as_mut().unwrap()[2];
    z.iter_mut().for_each(|z| *z = -*z);
    let words = said(&known, &swapped);
    assert!(words.starts_with("`z_m` negated; "), "{words}");
}

/// A tracker of left-handed axes gives its orientations about them too.
#[test]
fn left_handed_poses_are_named() {
    for (is_known, expected) in [
        (false, "the tracker's axes mirrored, which are left-handed"),
        (true, "`y_m` negated, orientations too; "),
    ] {
        let device = device(is_known);
        let mut wrong = seen(&device, true);
        let negate = |column: &mut Vec<f64>| column.iter_mut().for_each(|part| *part = -*part);
        negate(&mut wrong.position_m.as_mut().unwrap()[1]);
        // the axis of a turn is a pseudovector
        let [_, x, _, z] = wrong.orientation_wxyz.as_mut().unwrap();
        [x, z].into_iter().for_each(negate);
        let said = said(&device, &wrong);
        assert!(said.starts_with(expected), "{said}");
    }
}

#[test]
fn quaternions_in_another_order_are_named() {
    for is_known in [false, true] {
        let device = device(is_known);
        let right = seen(&device, true);
        check_rig(&device, &right).unwrap();
        let [w, x, y, z] = right.orientation_wxyz.clone().unwrap();
        let minus = |part: &Vec<f64>| part.iter().map(|part| -part).collect::<Vec<f64>>();
        let inverted = [w.clone(), minus(&x), minus(&y), minus(&z)];
        let last = [x.clone(), y.clone(), z.clone(), w.clone()];
        let both = [minus(&x), minus(&y), minus(&z), w];
        for (columns, words) in [
            (inverted, "the quaternions inverted; "),
            (last, "the quaternions read as x, y, z, w; "),
            (both, "the quaternions read as x, y, z, w and inverted; "),
        ] {
            let mut wrong = right.clone();
            wrong.orientation_wxyz = Some(columns);
            let said = said(&device, &wrong);
            assert!(said.starts_with(words), "{said}");
        }
    }
}

/// A device that is wrong by centimetres and degrees is not one in another convention.
#[test]
fn a_bad_device_file_is_not_called_left_handed() {
    let right = device(false);
    let recording = seen(&right, true);
    let mut wrong = right;
    wrong.links[2].a_m += 0.15;
    wrong.links[3].theta_rad += 1.5;
    check_rig(&wrong, &recording).unwrap();
}

fn compliant(truth_rad_per_nm: f64, has_masses: bool) -> Calibration {
    let mut nominal = device(false);
    nominal.surroundings.compliance = vec![
        JointCompliance {
            rad_per_nm: 0.0,
            fit: true,
        };
        JOINTS
    ];
    let mut truth = nominal.clone();
    truth.gravity_mps2 = Some([0.0, 0.0, -9.81]);
    let body = Body {
        mass_kg: 2.0,
        centre_of_mass_m: [0.1, 0.02, -0.03],
        inertia_kgm2: None,
    };
    truth.bodies = vec![Some(body); JOINTS + 1];
    if has_masses {
        nominal.gravity_mps2 = truth.gravity_mps2;
        nominal.bodies.clone_from(&truth.bodies);
    }
    for compliance in &mut truth.surroundings.compliance {
        compliance.rad_per_nm = truth_rad_per_nm;
    }
    truth.surroundings.tracker_base = Some(placement(5, 1.0, 0.0));
    truth.surroundings.tracker_tool = Some(placement(6, 0.1, 0.0));
    let mut recording = plain(readings(&truth, 120, 1.5, 3));
    tracked(&truth, &mut recording, 1.0, 9);
    let options = Options {
        held_out: HeldOut::None,
        ..Options::default()
    };
    calibrate(&nominal, &recording, &options).unwrap()
}

#[test]
fn compliances_without_a_load_and_against_it_are_told() {
    let nothing = "there is nothing to fit compliances from";
    let against = "yields against the load";
    for (rad_per_nm, has_masses, expected) in [
        (3e-4, true, [false, false]),
        (-3e-4, true, [false, true]),
        (3e-4, false, [true, false]),
    ] {
        let warnings = compliant(rad_per_nm, has_masses).warnings.join("\n");
        let have = [nothing, against].map(|words| warnings.contains(words));
        assert_eq!(have, expected, "{rad_per_nm} {has_masses}: {warnings}");
    }
}

/// Of a device without `[tracker]` positions are the handle's, in frame (-1). The same arm before an instrument with a frame
/// of its own ended at the iteration limit, or in a wobble of 175 mrad.
#[test]
fn positions_in_another_frame_are_named() {
    let unknown = device(false);
    let right = seen(&unknown, false);
    let mut bare = unknown.clone();
    bare.tracker = None;
    let words = said(&bare, &right);
    assert!(
        words.contains("base = \"unknown\" and tool = \"unknown\" in [tracker]"),
        "{words}"
    );
    // where it is elsewhere by the marker alone, the base stays
    let mut tool_alone = device(true);
    let mut truth = tool_alone.clone();
    truth.surroundings.tracker_base = Some(Placement::default());
    truth.surroundings.tracker_tool = Some(placement(6, 0.3, 0.0));
    let mut recording = plain_readings(&truth);
    tracked(&truth, &mut recording, 1.0, 9);
    recording.orientation_wxyz = None;
    let words = said(&tool_alone, &recording);
    assert!(
        words.starts_with("tool = \"unknown\" in [tracker]; "),
        "{words}"
    );
    tool_alone.tracker.as_mut().unwrap().tool_known = false;
    check_rig(&tool_alone, &recording).unwrap();
}

fn plain_readings(device: &Device) -> Recording {
    plain(readings(device, 60, 1.5, 3))
}

#[test]
fn poses_the_other_way_round_are_named() {
    let device = device(false);
    let right = seen(&device, true);
    let (positions, turns) = (
        right.position_m.clone().unwrap(),
        right.orientation_wxyz.clone().unwrap(),
    );
    let mut wrong = right.clone();
    for row in 0..right.len() {
        let turn = UnitQuaternion::from_quaternion(Quaternion::new(
            turns[0][row],
            turns[1][row],
            turns[2][row],
            turns[3][row],
        ));
        let seen = Isometry3::from_parts(
            Translation3::new(positions[0][row], positions[1][row], positions[2][row]),
            turn,
        );
        let back = seen.inverse();
        for axis in 0..3 {
            wrong.position_m.as_mut().unwrap()[axis][row] = back.translation.vector[axis];
        }
        let parts = [
            back.rotation.w,
            back.rotation.i,
            back.rotation.j,
            back.rotation.k,
        ];
        for (column, part) in wrong
            .orientation_wxyz
            .as_mut()
            .unwrap()
            .iter_mut()
            .zip(parts)
        {
            column[row] = part;
        }
    }
    let words = said(&device, &wrong);
    assert!(words.contains("the poses inverted, "), "{words}");
}

#[test]
fn positions_of_the_row_before_are_named() {
    for has_orientations in [false, true] {
        let device = device(false);
        let right = seen(&device, has_orientations);
        let rows = right.len();
        let rotated =
            |from: usize| -> Vec<usize> { (0..rows).map(|row| (row + from) % rows).collect() };
        for (by, words) in [
            (1, "measured a row later"),
            (rows - 1, "measured a row earlier"),
        ] {
            let moved = right.select(&rotated(rows - by));
            let mut wrong = right.clone();
            wrong.position_m.clone_from(&moved.position_m);
            wrong.orientation_wxyz.clone_from(&moved.orientation_wxyz);
            let said = said(&device, &wrong);
            assert!(said.contains(words), "{by}: {said}");
        }
    }
}

/// A motor's turns in place of a joint's angle, and an encoder that reads one value while its joint moves.
#[test]
fn a_gear_and_an_encoder_that_does_not_answer_are_named() {
    for (is_known, has_orientations) in [(true, false), (false, true)] {
        let device = device(is_known);
        let right = seen(&device, has_orientations);
        check_rig(&device, &right).unwrap();
        for (joint, gear) in [(0, 3.0), (1, 100.0), (2, 0.01), (3, -51.0)] {
            let mut wrong = right.clone();
            wrong.joint[joint]
                .iter_mut()
                .for_each(|angle| *angle *= gear);
            let words = said(&device, &wrong);
            let (does, about) = match f64::abs(gear) < 1.0 {
                true => ("times", 1.0 / gear),
                false => ("divided by", gear),
            };
            let column = format!("column `theta{}_rad` {does} ", joint + 1);
            let (_, stated) = words
                .split_once(&column)
                .unwrap_or_else(|| panic!("{words}"));
            let stated: f64 = stated
                .split([' ', ';', ','])
                .next()
                .unwrap()
                .parse()
                .unwrap();
            assert!((stated / about - 1.0).abs() < 0.02, "{words}");
        }
        for joint in 0..JOINTS - 1 {
            let mut wrong = right.clone();
            wrong.joint[joint].fill(0.0);
            let words = said(&device, &wrong);
            let column = format!("column `theta{}_rad` as the tracker shows", joint + 1);
            assert!(words.contains(&column), "{words}");
        }
    }
}
