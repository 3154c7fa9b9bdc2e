//! A heavy arm in single postures, seen by a tracker that stands and is fixed anywhere.

use haptical_diagnosis::{Diagnosis, Options, Verdict, diagnose};
use haptical_model::kinematics::nalgebra::{
    Isometry3, Matrix3, Point3, Rotation3, UnitQuaternion, Vector3,
};
use haptical_model::{Device, Evaluation, Placement, Recording, Tracker};

use crate::normal::Normal;
use crate::touching;

const POSITION_SD_M: f64 = 3e-5;
const JOINTS: usize = 6;
const POSTURES: usize = 200;
/// The joint that yields, and by how much.
const JOINT: usize = 1;
const STIFFNESS_NM_PER_RAD: f64 = 2e4;

fn device() -> Device {
    let mut device = touching::device();
    device.tracker = Some(Tracker {
        base_known: false,
        tool_known: false,
        position_sd_m: Some(POSITION_SD_M),
        rotation_sd_rad: None,
    });
    device.surroundings.tracker_base = Some(Placement::default());
    device.surroundings.tracker_tool = Some(Placement::default());
    device
}

/// Where the tracker stands, frame (-1) seen from it, far from no turn.
fn base() -> Isometry3<f64> {
    Isometry3::new(Vector3::new(1.7, -0.4, 0.6), Vector3::new(0.5, -1.2, 2.0))
}

/// The marker, seen from the handle \[m\].
const MARKER_M: Vector3<f64> = Vector3::new(0.09, -0.06, 0.14);

/// Postures under a load that is recorded; `noise_sd_m` of each coordinate.
fn recorded(seed: u64, stiffness_nm_per_rad: f64, noise_sd_m: f64) -> Recording {
    let mut built = touching::device();
    built.links[2].a_m += 4e-4;
    built.links[4].d_m -= 3e-4;
    let mut random = Normal::new(seed);
    let mut evaluation = Evaluation::new(&built);
    let mut recording = Recording {
        line: (2..).take(POSTURES).collect(),
        joint: vec![Vec::new(); JOINTS],
        output: vec![None; JOINTS],
        torque_nm: vec![Some(Vec::new()); JOINTS],
        ..Recording::default()
    };
    let mut position_m = [(); 3].map(|()| Vec::new());
    for _ in 0..POSTURES {
        let reading: Vec<f64> = (0..JOINTS).map(|_| 0.7 * random.next()).collect();
        let torque: Vec<f64> = (0..JOINTS).map(|_| 8.0 * random.next()).collect();
        evaluation.move_to(&reading).unwrap();
        let mut link: Vec<f64> = (0..JOINTS)
            .map(|joint| evaluation.output_rad(joint))
            .collect();
        link[JOINT] -= torque[JOINT] / stiffness_nm_per_rad;
        evaluation.move_outputs(&link).unwrap();
        let pose = evaluation.pose().unwrap();
        let rotation: Matrix3<f64> = pose.rotation;
        let turn =
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
        let seen = base() * Point3::from(turn * MARKER_M + pose.position_m);
        for (axis, column) in position_m.iter_mut().enumerate() {
            column.push(seen[axis] + noise_sd_m * random.next());
        }
        for (column, reading) in recording.joint.iter_mut().zip(&reading) {
            column.push(*reading);
        }
        for (column, torque) in recording.torque_nm.iter_mut().zip(&torque) {
            column.as_mut().unwrap().push(*torque);
        }
    }
    recording.position_m = Some(position_m);
    recording
}

fn diagnosed(recording: &Recording) -> Diagnosis {
    diagnose(&device(), recording, &Options::default()).unwrap()
}

#[test]
fn a_joint_that_yields_is_named_wherever_the_tracker_stands() {
    for seed in [1, 2, 3] {
        let diagnosis = diagnosed(&recorded(seed, STIFFNESS_NM_PER_RAD, POSITION_SD_M));
        assert_eq!(diagnosis.verdict, Verdict::Named, "{:?}", diagnosis.causes);
        let cause = &diagnosis.causes[0];
        assert_eq!(cause.effect, "joint-compliance", "seed {seed}");
        assert_eq!(cause.joint, Some(JOINT + 1), "seed {seed}");
        let [low, high] = cause.parameters["stiffness_nm_per_rad"].ci95;
        assert!((low..high).contains(&STIFFNESS_NM_PER_RAD), "{low} {high}");
    }
}

/// Free functions of an angle explain a hundredth of any noise: that is no place.
#[test]
fn noise_larger_than_stated_is_placed_nowhere() {
    for seed in [1, 2, 3] {
        let diagnosis = diagnosed(&recorded(seed, f64::INFINITY, 2.0 * POSITION_SD_M));
        assert_eq!(diagnosis.verdict, Verdict::Unknown, "seed {seed}");
        let place = diagnosis.place.unwrap();
        assert_eq!(
            (place.joint, place.depends_on.len()),
            (None, 0),
            "{}",
            place.region
        );
    }
}

/// And a gap that does depend on an angle keeps its joint.
#[test]
fn a_law_that_is_not_in_the_catalogue_is_placed_at_its_joint() {
    let mut recording = recorded(4, f64::INFINITY, POSITION_SD_M);
    let device = touching::device();
    let mut evaluation = Evaluation::new(&device);
    for row in 0..recording.len() {
        let reading: Vec<f64> = recording.joint.iter().map(|column| column[row]).collect();
        evaluation.move_to(&reading).unwrap();
        let mut link: Vec<f64> = (0..JOINTS)
            .map(|joint| evaluation.output_rad(joint))
            .collect();
        let before = evaluation.pose().unwrap().position_m;
        // a step within a tenth of a radian, which no eccentricity has
        link[3] += 2e-3 * (reading[3] / 0.03).tanh();
        evaluation.move_outputs(&link).unwrap();
        let moved = base().rotation * (evaluation.pose().unwrap().position_m - before);
        for (axis, column) in recording
            .position_m
            .as_mut()
            .unwrap()
            .iter_mut()
            .enumerate()
        {
            column[row] += moved[axis];
        }
    }
    let diagnosis = diagnosed(&recording);
    assert_ne!(diagnosis.verdict, Verdict::NoGap);
    assert_eq!(diagnosis.place.unwrap().joint, Some(4));
}
