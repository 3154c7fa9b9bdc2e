//! Logs in which a joint runs backwards, or two joints are in each other's column.

use haptical_calibration::{CalibrationError, HeldOut, Options, Weighting, calibrate, check_rig};
use haptical_model::transmission::CapstanError;
use haptical_model::{Device, Recording, TransmissionError};

use crate::rig_scene::{placement, plain, readings, table, tracked, unknown_tracker};

/// A device, and a log of it in which a tracker sees the handle; the device's lengths differ by a millimetre.
fn scene(place_known: bool) -> (Device, Recording) {
    let mut nominal = table(6);
    unknown_tracker(&mut nominal);
    let mut truth = nominal.clone();
    for (row, link) in truth.links.iter_mut().enumerate() {
        link.a_m += 1e-3 * (row % 3) as f64 - 1e-3;
        link.d_m -= 5e-4 * (row % 2) as f64;
    }
    truth.surroundings.tracker_base = Some(placement(5, 1.0, 0.0));
    truth.surroundings.tracker_tool = Some(placement(6, 0.1, 0.0));
    let mut recording = plain(readings(&truth, 150, 1.4, 3));
    tracked(&truth, &mut recording, 1.0, 9);
    if place_known {
        nominal.surroundings = truth.surroundings.clone();
        let tracker = nominal.tracker.as_mut().unwrap();
        (tracker.base_known, tracker.tool_known) = (true, true);
    }
    recording.orientation_wxyz = None;
    (nominal, recording)
}

fn refusal(device: &Device, recording: &Recording) -> Option<String> {
    let options = Options {
        weighting: Weighting::Stated,
        held_out: HeldOut::None,
        ..Options::default()
    };
    match calibrate(device, recording, &options) {
        Err(
            error @ (CalibrationError::MistakenColumns { .. }
            | CalibrationError::MistakenLog { .. }),
        ) => Some(error.to_string()),
        Err(error) => panic!("{error}"),
        Ok(_) => None,
    }
}

#[test]
fn a_column_that_runs_backwards_is_named() {
    for place_known in [false, true] {
        let (device, recording) = scene(place_known);
        assert_eq!(refusal(&device, &recording), None);
        for joint in [1, 3] {
            let mut turned = recording.clone();
            turned.joint[joint]
                .iter_mut()
                .for_each(|reading| *reading = -*reading);
            let said = refusal(&device, &turned).unwrap();
            let name = format!("column `theta{}_rad` negated", joint + 1);
            assert!(said.contains(&name), "{said}");
        }
    }
}

#[test]
fn swapped_columns_are_named() {
    let (device, mut recording) = scene(false);
    recording.joint.swap(0, 2);
    let said = refusal(&device, &recording).unwrap();
    assert!(
        said.contains("columns `theta1_rad` and `theta3_rad` swapped"),
        "{said}"
    );
}

/// A device five centimetres from its file is calibrated, not told that its log is wrong.
#[test]
fn a_device_far_from_its_file_has_no_mistaken_column() {
    let (mut device, recording) = scene(false);
    device.links[2].a_m += 0.05;
    device.links[3].theta_rad += 0.2;
    assert_eq!(refusal(&device, &recording), None);
}

/// With external encoders each `out` is compared with each `theta` first: no fit is tried on what is swapped.
#[test]
fn external_encoders_of_other_joints_are_named() {
    let Some(nominal) = crate::haptic::haptic7() else {
        return;
    };
    let truth = crate::haptic::truth_of(&nominal, 1.0);
    let right = crate::haptic::record(&truth, 200, 3, haptical_simulator::Noise::Gaussian);
    check_rig(&nominal, &right).unwrap();
    let said = |change: &dyn Fn(&mut Recording)| {
        let mut wrong = right.clone();
        change(&mut wrong);
        check_rig(&nominal, &wrong).unwrap_err().to_string()
    };
    let times = |column: &mut Option<Vec<f64>>, factor: f64| {
        column
            .iter_mut()
            .flatten()
            .for_each(|reading| *reading *= factor);
    };
    let words = said(&|log| log.output.swap(0, 1));
    assert!(
        words.contains("with columns `out1_rad` and `out2_rad` swapped: "),
        "{words}"
    );
    // a copy of another joint's column, and the column of a joint without an encoder
    let words = said(&|log| log.output[1] = log.output[2].clone());
    assert!(
        words.contains("with column `out2_rad` left out, which follows `theta3_rad`: "),
        "{words}"
    );
    // the cable says that the joints' columns are swapped, not those of the encoders
    let words = said(&|log| log.joint.swap(1, 4));
    assert!(
        words.contains("with columns `theta2_rad` and `theta5_rad` swapped: "),
        "{words}"
    );
    let words = said(&|log| times(&mut log.output[2], -1.0));
    assert!(
        words.contains("with column `out3_rad` negated: "),
        "{words}"
    );
    let words = said(&|log| times(&mut log.output[0], 57.295_779_5));
    assert!(
        words.contains("with column `out1_rad` divided by 56.")
            && words.contains("57.3 are degrees"),
        "{words}"
    );
    let words = said(&|log| {
        for reading in &mut log.joint[1] {
            *reading = (*reading * 1304.0).round();
        }
    });
    assert!(
        words.contains("with column `theta2_rad` divided by 1297."),
        "{words}"
    );
    // without a cable either column may be the wrong one
    let words = said(&|log| {
        log.cable_m = vec![None];
        times(&mut log.output[2], -1.0);
    });
    assert!(
        words.contains("with column `out3_rad` negated, or column `theta3_rad` negated: "),
        "{words}"
    );
}

/// Before any fit: what a change of columns or rows brings several times nearer, by positions, and by a cable alone.
#[test]
fn mistakes_that_are_gross_show_before_a_fit() {
    let Some(nominal) = crate::haptic::haptic7() else {
        return;
    };
    let truth = crate::haptic::truth_of(&nominal, 1.0);
    let mut by_cable = crate::haptic::record(&truth, 200, 3, haptical_simulator::Noise::Gaussian);
    by_cable.output.iter_mut().for_each(|column| *column = None);
    let all = |log: &Recording, by: usize| -> Vec<usize> {
        (0..log.len()).map(|row| (row + by) % log.len()).collect()
    };
    for (device, right) in [scene(true), scene(false), (nominal, by_cable)] {
        check_rig(&device, &right).unwrap();
        let said = |change: &dyn Fn(&mut Recording)| {
            let mut wrong = right.clone();
            change(&mut wrong);
            match check_rig(&device, &wrong).unwrap_err() {
                error @ CalibrationError::MistakenLog { .. } => error.to_string(),
                other => panic!("{other}"),
            }
        };
        let words = said(&|log| log.joint[1].iter_mut().for_each(|reading| *reading *= -1.0));
        assert!(words.contains("column `theta2_rad` negated"), "{words}");
        let words = said(&|log| log.joint.swap(1, 3));
        assert!(
            words.contains("columns `theta2_rad` and `theta4_rad` swapped"),
            "{words}"
        );
        // counted from the horizontal, counts per turn wrong by two
        let words = said(&|log| {
            let second = log.joint[1].clone();
            let pairs = log.joint[2].iter_mut().zip(second);
            pairs.for_each(|(reading, second)| *reading -= second);
        });
        assert!(
            words.contains("with column `theta3_rad` plus `theta2_rad`: "),
            "{words}"
        );
        for (factor, expected) in [
            (0.5, "`theta3_rad` times 2: "),
            (2.0, "`theta3_rad` divided by 2: "),
            (57.295_779_5, "`theta3_rad` times pi/180: "),
        ] {
            let words = said(&|log| {
                let column = log.joint[2].iter_mut();
                column.for_each(|reading| *reading *= factor);
            });
            assert!(words.contains(expected), "{words}");
        }
        let words = said(&|log| log.joint.reverse());
        assert!(words.contains("all joints in reverse order"), "{words}");
        for (by, expected) in [(1, "a row earlier"), (right.len() - 1, "a row later")] {
            let words = said(&|log| {
                let moved = right.select(&all(log, by));
                log.cable_m.clone_from(&moved.cable_m);
                log.position_m.clone_from(&moved.position_m);
            });
            assert!(words.contains(expected), "{words}");
        }
    }
}

/// A change that takes a joint beyond what its transmission can do leaves no pose, which misses nothing.
#[test]
fn a_change_without_poses_is_none() {
    let Some(nominal) = crate::haptic::haptic7() else {
        return;
    };
    let truth = crate::haptic::truth_of(&nominal, 1.0);
    let mut log = crate::haptic::record(&truth, 200, 3, haptical_simulator::Noise::Gaussian);
    log.output.iter_mut().for_each(|column| *column = None);
    let mut far = nominal;
    far.links[2].d_m += 0.15;
    far.links[3].theta_rad += 0.4;
    far.joints[3].transmission_error = TransmissionError::Parallelogram {
        capstan: CapstanError::default(),
        length_deviations_m: [2e-3, 0.0, 0.0, 0.0],
    };
    check_rig(&far, &log).unwrap();
}

/// A sensor may be late by a row of a fast log; that is an effect, not a log put together wrongly.
#[test]
fn a_row_is_a_latency_where_rows_are_close() {
    let (device, right) = scene(true);
    let mut late = right.clone();
    let rows: Vec<usize> = (0..right.len()).map(|row| row.saturating_sub(1)).collect();
    late.position_m.clone_from(&right.select(&rows).position_m);
    assert!(check_rig(&device, &late).is_err());
    late.time_s = Some((0..right.len()).map(|row| 1e-3 * row as f64).collect());
    check_rig(&device, &late).unwrap();
}

/// Rows that are held out leave gaps in the fit's part of a log: rows on both sides of them are no neighbours.
#[test]
fn a_row_off_is_named_where_rows_are_held_out() {
    let Some(nominal) = crate::haptic::haptic7() else {
        return;
    };
    let truth = crate::haptic::truth_of(&nominal, 1.0);
    let mut log = crate::haptic::record(&truth, 300, 3, haptical_simulator::Noise::Gaussian);
    // slow enough that a row off is less than what the device file is off by
    for (joint, column) in log.joint.iter_mut().enumerate() {
        let turns = 1.0 + 0.37 * joint as f64;
        let angle = |row: usize| {
            0.6 * (turns * std::f64::consts::TAU * row as f64 / 300.0 + joint as f64).sin()
        };
        column
            .iter_mut()
            .enumerate()
            .for_each(|(row, reading)| *reading = angle(row));
    }
    log.output.iter_mut().for_each(|column| *column = None);
    let poses = haptical_simulator::true_poses(&truth, &log).unwrap();
    let late = |row: usize| poses[row.saturating_sub(1)].position_m.norm();
    log.cable_m[0] = Some((0..300).map(late).collect());
    check_rig(&nominal, &log).unwrap();
    let refused = calibrate(&nominal, &log, &Options::default()).unwrap_err();
    assert!(
        matches!(&refused, CalibrationError::MistakenColumns { what, .. } if what.contains("a row later")),
        "{refused}"
    );
}
