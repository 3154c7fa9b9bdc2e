//! A tracker that someone moves between two runs, and one that nobody touches.

use haptical_diagnosis::{Diagnosis, Options, Verdict, diagnose};
use haptical_model::kinematics::Link;
use haptical_model::kinematics::nalgebra::{
    Isometry3, Matrix3, Quaternion, Rotation3, Translation3, UnitQuaternion, Vector3,
};
use haptical_model::{Device, Evaluation, Placement, Recording, Tracker};

use crate::arm::{self, Errors, Session, assert_near, record, summary};
use crate::normal::Normal;

const POSITION_SD_M: f64 = 5e-5;
const ROTATION_SD_RAD: f64 = 2e-4;

/// The arm before a tracker whose place, and that of its target, are unknown.
fn device() -> Device {
    let mut device = arm::device();
    device.cables.clear();
    device.tracker = Some(Tracker {
        base_known: false,
        base_per_run: false,
        tool_known: false,
        position_sd_m: Some(POSITION_SD_M),
        rotation_sd_rad: Some(ROTATION_SD_RAD),
        scale_sd: None,
    });
    device.surroundings.tracker_base = Some(Placement::default());
    device.surroundings.tracker_tool = Some(Placement::default());
    device
}

/// Frame (-1) seen from the tracker, and the target seen from the handle.
fn base() -> Isometry3<f64> {
    Isometry3::new(Vector3::new(0.9, -0.4, 0.6), Vector3::new(0.5, -1.2, 2.0))
}
fn target() -> Isometry3<f64> {
    Isometry3::new(
        Vector3::new(0.04, -0.03, 0.05),
        Vector3::new(0.3, 0.2, -0.8),
    )
}

/// What a tracker records whose frame is displaced by `moved` from the second run on, and whose readings of positions
/// `disturbed` adds to.
fn recorded(
    session: &Session,
    moved: Isometry3<f64>,
    disturbed: impl Fn(f64) -> Vector3<f64>,
) -> Recording {
    recorded_from(session, &[(session.rows_of_a_run, moved)], disturbed)
}

/// The same with displacements from rows on, one after the other.
fn recorded_from(
    session: &Session,
    moves: &[(usize, Isometry3<f64>)],
    disturbed: impl Fn(f64) -> Vector3<f64>,
) -> Recording {
    let mut recording = record(session, |_| Errors::default());
    recording.cable_m.clear();
    let built = arm::built();
    let mut evaluation = Evaluation::new(&built);
    let mut noise = Normal::new(session.seed + 100);
    let mut position_m = [(); 3].map(|()| Vec::new());
    let mut orientation = [(); 4].map(|()| Vec::new());
    for row in 0..recording.len() {
        let readings: Vec<f64> = recording.joint.iter().map(|column| column[row]).collect();
        evaluation.move_to(&readings).unwrap();
        let pose = evaluation.pose().unwrap();
        let rotation: Matrix3<f64> = pose.rotation;
        let rotation = Rotation3::from_matrix_unchecked(rotation);
        let handle = Isometry3::from_parts(
            Translation3::from(pose.position_m),
            UnitQuaternion::from_rotation_matrix(&rotation),
        );
        let mut seen = base() * handle * target();
        for (_, moved) in moves.iter().filter(|(first, _)| row >= *first) {
            seen = moved.inverse() * seen;
        }
        let time_s = recording.time_s.as_ref().unwrap()[row];
        let at = seen.translation.vector + disturbed(time_s);
        for (axis, column) in position_m.iter_mut().enumerate() {
            column.push(at[axis] + POSITION_SD_M * noise.next());
        }
        let jitter = Vector3::from_fn(|_, _| ROTATION_SD_RAD * noise.next());
        let turn = UnitQuaternion::from_scaled_axis(jitter) * seen.rotation;
        for (column, part) in orientation.iter_mut().zip([turn.w, turn.i, turn.j, turn.k]) {
            column.push(part);
        }
    }
    recording.position_m = Some(position_m);
    recording.orientation_wxyz = Some(orientation);
    recording
}

fn diagnosed(recording: &Recording) -> Diagnosis {
    diagnose(&device(), recording, &Options::default()).unwrap()
}

fn still(_: f64) -> Vector3<f64> {
    Vector3::zeros()
}

#[test]
fn a_tracker_that_was_moved_between_runs_is_named_with_shift_and_tilt() {
    // 2 mm and 3 mrad, neither along an axis
    let shift = 2e-3 * Vector3::new(0.6, -0.64, 0.48);
    let tilt = 3e-3 * Vector3::new(-0.48, 0.6, 0.64);
    for runs in [2, 3] {
        let session = Session {
            runs,
            rows_of_a_run: 2400 / runs,
            ..Session::default()
        };
        let diagnosis = diagnosed(&recorded(&session, Isometry3::new(shift, tilt), still));
        let summary = summary(&diagnosis);
        assert_eq!(diagnosis.verdict, Verdict::Named, "{summary}");
        assert_eq!(diagnosis.causes.len(), 1, "{summary}");
        let cause = &diagnosis.causes[0];
        assert_eq!(cause.effect, "tracker-moved", "{summary}");
        let near = |name: &str, truth: f64| {
            let answer = cause.parameters[name];
            assert_near((answer.value, answer.ci95), truth);
            assert!(
                (answer.value / truth - 1.0).abs() < 0.05,
                "{name} {answer:?}"
            );
        };
        near("shift_m", 2e-3);
        near("tilt_rad", 3e-3);
        let place = diagnosis.place.unwrap();
        assert_eq!(place.depends_on, ["run"], "{}", place.region);
    }
}

#[test]
fn a_tracker_that_was_moved_before_each_run_is_named_with_each() {
    let session = Session {
        runs: 3,
        rows_of_a_run: 800,
        ..Session::default()
    };
    let moves = [(800, 2e-3), (1600, -3e-3)].map(|(row, shift_m)| {
        let shift = shift_m * Vector3::new(0.6, -0.64, 0.48);
        (row, Isometry3::new(shift, Vector3::zeros()))
    });
    let diagnosis = diagnosed(&recorded_from(&session, &moves, still));
    let summary = summary(&diagnosis);
    assert_eq!(diagnosis.verdict, Verdict::Named, "{summary}");
    let causes = diagnosis.causes.iter();
    let mut found: Vec<(f64, f64)> = causes
        .map(|cause| {
            assert_eq!(cause.effect, "tracker-moved", "{summary}");
            let number = |name: &str| cause.parameters[name].value;
            (number("from_run"), number("shift_m"))
        })
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let runs: Vec<f64> = found.iter().map(|cause| cause.0).collect();
    assert_eq!(runs, [2.0, 3.0], "{summary}");
    for ((_, shift_m), truth_m) in found.iter().zip([2e-3, 3e-3]) {
        assert!(
            (shift_m / truth_m - 1.0).abs() < 0.05,
            "{shift_m} {truth_m}"
        );
    }
    // rows of each run were held back, as a whole run says nothing of what moved before it
    let closed = diagnosis.gap.channels[0].reduction_ci95.unwrap();
    assert!(closed[0] > 75.0, "{closed:?}");
}

#[test]
fn a_place_for_each_run_takes_up_what_moved_and_is_not_tested() {
    let moved = Isometry3::new(Vector3::new(0.2, -0.1, 0.3), Vector3::new(0.4, 0.2, -0.3));
    let session = Session {
        runs: 3,
        rows_of_a_run: 800,
        ..Session::default()
    };
    let mut device = device();
    device.surroundings.tracker_base = None;
    device.tracker.as_mut().unwrap().base_per_run = true;
    let recording = recorded(&session, moved, still);
    let diagnosis = diagnose(&device, &recording, &Options::default()).unwrap();
    let summary = summary(&diagnosis);
    assert_eq!(diagnosis.verdict, Verdict::NoGap, "{summary}");
    let mut untestable = diagnosis.untestable.iter();
    let own = untestable.find(|other| other.effect == "tracker-moved");
    let why = &own.unwrap().why;
    assert!(why.contains("a tracker place of its own"), "{why}");
}

/// A new homing between two runs shows on handle and tracker alike; neither was touched.
#[test]
fn a_zero_that_is_another_one_between_runs_is_named_at_its_joint() {
    let session = Session {
        runs: 2,
        rows_of_a_run: 1200,
        ..Session::default()
    };
    for (joint, offset_rad) in [(0, 1e-3), (1, -2e-3), (2, 1.5e-3)] {
        let mut recording = recorded(&session, Isometry3::identity(), still);
        for reading in &mut recording.joint[joint][1200..] {
            *reading -= offset_rad;
        }
        // the tracker alone
        recording.output.fill(None);
        let diagnosis = diagnosed(&recording);
        let summary = summary(&diagnosis);
        assert_eq!(diagnosis.causes.len(), 1, "{summary}");
        let cause = &diagnosis.causes[0];
        assert_eq!(cause.effect, "zero-changed", "{summary}");
        assert_eq!(cause.joint, Some(joint + 1), "{summary}");
        let answer = cause.parameters["offset_rad"];
        assert_near((answer.value, answer.ci95), offset_rad);
        // of the first joint a turn of the base is the same, of the last a turn of the target
        let rivals = &cause.confusable_with;
        let is_base = rivals
            .iter()
            .any(|rival| rival.starts_with("tracker-moved"));
        assert_eq!(is_base, joint == 0, "{rivals:?}");
    }
}

#[test]
fn a_tracker_that_nobody_touches_has_no_gap() {
    for seed in 1..=4 {
        let session = Session {
            seed,
            ..Session::default()
        };
        let diagnosis = diagnosed(&recorded(&session, Isometry3::identity(), still));
        assert_eq!(diagnosis.verdict, Verdict::NoGap, "{}", summary(&diagnosis));
        assert!(diagnosis.causes.is_empty(), "{}", summary(&diagnosis));
    }
}

#[test]
fn a_stand_that_vibrates_is_one_oscillation_on_all_axes() {
    let sway = |time_s: f64| {
        let turned = std::f64::consts::TAU * 12.9 * time_s;
        1e-4 * Vector3::new(3.0 * turned.cos(), 1.0 * turned.sin(), 0.5 * turned.cos())
    };
    let diagnosis = diagnosed(&recorded(&Session::default(), Isometry3::identity(), sway));
    let found = arm::assert_named(&diagnosis, "periodic-disturbance", None, "amplitude_m");
    // the long half axis of the ellipse
    assert_near(found, 1e-4 * f64::hypot(3.0, 0.5));
}

#[test]
fn a_tracker_that_stands_elsewhere_than_in_an_earlier_model_is_named() {
    let one = Session {
        runs: 1,
        rows_of_a_run: 2400,
        ..Session::default()
    };
    let before = diagnosed(&recorded(&one, Isometry3::identity(), still)).device;
    let later = Session { seed: 9, ..one };
    let against = |recording: &Recording, without: &[&str]| {
        let options = Options {
            model: Some(&before),
            without: without.iter().map(|name| (*name).to_owned()).collect(),
            ..Options::default()
        };
        diagnose(&device(), recording, &options).unwrap()
    };
    let shift = 2e-3 * Vector3::new(0.6, -0.64, 0.48);
    let tilt = 3e-3 * Vector3::new(-0.48, 0.6, 0.64);
    let recording = recorded_from(&later, &[(0, Isometry3::new(shift, tilt))], still);
    // without the model the place is fitted anew
    assert_eq!(diagnosed(&recording).verdict, Verdict::NoGap);
    let diagnosis = against(&recording, &[]);
    let summary = summary(&diagnosis);
    assert_eq!(diagnosis.verdict, Verdict::Named, "{summary}");
    let cause = &diagnosis.causes[0];
    assert_eq!(cause.effect, "tracker-moved", "{summary}");
    for (name, truth) in [("shift_m", 2e-3), ("tilt_rad", 3e-3)] {
        let answer = cause.parameters[name];
        assert_near((answer.value, answer.ci95), truth);
        assert!(
            (answer.value / truth - 1.0).abs() < 0.05,
            "{name} {answer:?}"
        );
    }
    assert_eq!(
        against(&recording, &["tracker-moved"]).verdict,
        Verdict::Unknown
    );
    let still_there = recorded(&later, Isometry3::identity(), still);
    assert_eq!(against(&still_there, &[]).verdict, Verdict::NoGap);
}

/// A tracker whose place and target were fitted does not tell the zeros of the first and the last joint from them: against an earlier
/// model they are candidates all the same.
#[test]
fn a_zero_that_no_recording_tells_alone_is_told_against_an_earlier_model() {
    let one = Session {
        runs: 1,
        rows_of_a_run: 2400,
        ..Session::default()
    };
    let blind = |mut recording: Recording| {
        recording.output.fill(None);
        recording
    };
    let before = blind(recorded(&one, Isometry3::identity(), still));
    let model = diagnosed(&before).device;
    let later = Session { seed: 9, ..one };
    let later = blind(recorded(&later, Isometry3::identity(), still));
    let last = model.joints.len() - 1;
    for joint in 0..=last {
        let offset_rad = 1e-3;
        let mut recording = later.clone();
        recording.joint[joint]
            .iter_mut()
            .for_each(|reading| *reading -= offset_rad);
        let options = Options {
            model: Some(&model),
            ..Options::default()
        };
        let diagnosis = diagnose(&device(), &recording, &options).unwrap();
        let summary = summary(&diagnosis);
        let cause = &diagnosis.causes[0];
        assert_eq!(cause.effect, "joint-offset", "{joint}: {summary}");
        assert_eq!(cause.joint, Some(joint + 1), "{summary}");
        let [number] = cause.changed.as_slice() else {
            panic!("{:?}", cause.changed);
        };
        let ci95 = number.value.ci95.map(|end| end - number.earlier);
        assert_near((number.value.value - number.earlier, ci95), offset_rad);
        assert!(ci95[1] - ci95[0] < 0.2 * offset_rad, "{joint}: {ci95:?}");
        let is_base = cause
            .confusable_with
            .iter()
            .any(|rival| rival.starts_with("tracker-moved"));
        assert_eq!(is_base, joint == 0, "{:?}", cause.confusable_with);
    }
}

/// A model that was fitted to positions alone does not say how the target is turned: a recording with orientations too is compared by
/// its positions.
#[test]
fn orientations_of_which_the_earlier_model_knows_nothing_are_left_out() {
    let one = Session {
        runs: 1,
        rows_of_a_run: 2400,
        ..Session::default()
    };
    let before = Recording {
        orientation_wxyz: None,
        ..recorded(&one, Isometry3::identity(), still)
    };
    let model = diagnosed(&before).device;
    let later = Session { seed: 9, ..one };
    let recording = recorded(&later, Isometry3::identity(), still);
    assert!(recording.orientation_wxyz.is_some());
    let options = Options {
        model: Some(&model),
        ..Options::default()
    };
    let diagnosis = diagnose(&device(), &recording, &options).unwrap();
    let summary = summary(&diagnosis);
    assert_eq!(diagnosis.verdict, Verdict::NoGap, "{summary}");
}

/// What the target is turned by is no number of the device and no shift of the tool: a difference that bears no name is a gap.
#[test]
fn a_difference_without_a_name_is_no_sound_device() {
    let one = Session {
        runs: 1,
        rows_of_a_run: 2400,
        ..Session::default()
    };
    let model = diagnosed(&recorded(&one, Isometry3::identity(), still)).device;
    let later = Session { seed: 9, ..one };
    let mut recording = recorded(&later, Isometry3::identity(), still);
    let turn = UnitQuaternion::from_scaled_axis(Vector3::new(3e-3, 2e-3, 0.0));
    let parts = recording.orientation_wxyz.as_mut().unwrap();
    for row in 0..parts[0].len() {
        let [w, i, j, k] = parts.each_ref().map(|part| part[row]);
        let own = UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k)) * turn;
        for (part, value) in parts.iter_mut().zip([own.w, own.i, own.j, own.k]) {
            part[row] = value;
        }
    }
    let options = Options {
        model: Some(&model),
        ..Options::default()
    };
    let diagnosis = diagnose(&device(), &recording, &options).unwrap();
    assert_eq!(
        diagnosis.verdict,
        Verdict::Unknown,
        "{}",
        summary(&diagnosis)
    );
}

/// A number of a link.
type Number = fn(&mut Link) -> &mut f64;

/// Two causes at once are two terms: the place of the tracker takes no link's part, nor links the place's. A zero that moved is no
/// link that was bent, and the answer says what changed since the model, not since the drawing.
#[test]
fn a_tracker_that_was_moved_beside_a_changed_link_is_named_with_it() {
    let one = Session {
        runs: 1,
        rows_of_a_run: 2400,
        ..Session::default()
    };
    let model = diagnosed(&recorded(&one, Isometry3::identity(), still)).device;
    let later = Session { seed: 9, ..one };
    let shift = 2e-3 * Vector3::new(0.6, -0.64, 0.48);
    let tilt = 3e-3 * Vector3::new(-0.48, 0.6, 0.64);
    let recording = recorded_from(&later, &[(0, Isometry3::new(shift, tilt))], still);
    let changes: [(&str, &str, Number); 2] = [
        ("joint-offset", "theta2", |link| &mut link.theta_rad),
        ("link-geometry", "alpha2", |link| &mut link.alpha_rad),
    ];
    for (effect, number, of) in changes {
        let mut before = model.clone();
        *of(&mut before.links[2]) += 8e-3;
        let options = Options {
            model: Some(&before),
            ..Options::default()
        };
        let diagnosis = diagnose(&device(), &recording, &options).unwrap();
        let summary = summary(&diagnosis);
        assert_eq!(diagnosis.verdict, Verdict::Named, "{summary}");
        let names = diagnosis
            .causes
            .iter()
            .map(|cause| (cause.effect.as_str(), cause.joint));
        let mut names: Vec<_> = names.collect();
        names.sort_unstable();
        let expected = [(effect, Some(2)), ("tracker-moved", None)];
        assert_eq!(names, expected, "{summary}");
        let place = diagnosis.causes.iter().find(|cause| cause.joint.is_none());
        for (name, truth) in [("shift_m", 2e-3), ("tilt_rad", 3e-3)] {
            let answer = place.unwrap().parameters[name];
            assert!(
                (answer.value / truth - 1.0).abs() < 0.1,
                "{name} {answer:?}"
            );
        }
        let link = diagnosis.causes.iter().find(|cause| cause.effect == effect);
        let changed = &link.unwrap().changed;
        let [only] = changed.as_slice() else {
            panic!("{changed:?}");
        };
        assert_eq!(
            (only.parameter.as_str(), only.unit.as_str()),
            (number, "rad")
        );
        assert_eq!(only.earlier, *of(&mut before.links[2]));
        // it was 8 mrad more
        let step = only.value.value - only.earlier;
        assert!((step + 8e-3).abs() < 4e-4, "{only:?}");
        let ci95 = only.value.ci95.map(|end| end - only.earlier);
        assert!(ci95[0] < -8e-3 && -8e-3 < ci95[1], "{only:?}");
    }
}
