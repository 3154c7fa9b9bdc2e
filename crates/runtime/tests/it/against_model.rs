//! Every number of a step against `haptical_model::Evaluation`, which computes it from `libm` row by
//! row.

use haptical_model::kinematics::{joint_torques_nm, nalgebra::Vector3};
use haptical_model::{Device, Evaluation};
use haptical_runtime::{RuntimeError, State, Twist};
use proptest::collection::vec;
use proptest::prelude::*;

use crate::devices::{any_device, any_drives, any_general_device, coupled, model};

/// Numbers here are of the size of 1; both sides round some hundred times.
const TOLERANCE: f64 = 1e-12;

fn near(ours: f64, theirs: f64, what: &str) {
    near_beside(1.0, ours, theirs, what);
}

/// Near a dead point the output goes with the root of how far that is: an error of that distance changes a slope `s` by `s^3` of it.
fn near_beside(slope: f64, ours: f64, theirs: f64, what: &str) {
    let tolerance = TOLERANCE * slope.powi(2).max(1.0);
    // Not `>`: NaN must fail as well.
    let is_near = (ours - theirs).abs() <= tolerance * theirs.abs().max(1.0);
    assert!(is_near, "{what}: {ours:?} here, {theirs:?} there");
}

fn all_near(ours: &Vector3<f64>, theirs: &Vector3<f64>, what: &str) {
    for (ours, theirs) in ours.iter().zip(theirs.iter()) {
        near(*ours, *theirs, what);
    }
}

/// A step of both, and every number compared; refusals must agree too.
pub(crate) fn compare<const JOINTS: usize>(device: &Device, readings: &[f64], force_n: [f64; 3]) {
    let step = |readings: &[f64; JOINTS]| model::<JOINTS>(device).step(readings);
    compare_step(device, step, readings, force_n);
}

/// As [`compare`], for rows that follow a joint.
fn compare_coupled<const JOINTS: usize, const ROWS: usize>(
    device: &Device,
    readings: &[f64],
    force_n: [f64; 3],
) {
    let step = |readings: &[f64; JOINTS]| coupled::<JOINTS, ROWS>(device).step(readings);
    compare_step(device, step, readings, force_n);
}

fn compare_step<const JOINTS: usize>(
    device: &Device,
    step: impl Fn(&[f64; JOINTS]) -> Result<State<JOINTS>, RuntimeError>,
    readings: &[f64],
    force_n: [f64; 3],
) {
    let readings: [f64; JOINTS] = std::array::from_fn(|joint| readings[joint]);
    let mut evaluation = Evaluation::new(device);
    let theirs = evaluation.move_to(&readings);
    let ours = step(&readings);
    let (Ok(()), Ok(state)) = (&theirs, &ours) else {
        assert!(
            theirs.is_err() && ours.is_err(),
            "{theirs:?} there, {ours:?} here"
        );
        return;
    };
    let pose = evaluation.pose().unwrap();
    all_near(&state.pose.position_m, &pose.position_m, "position");
    for (component, expected) in state.pose.rotation.iter().zip(&pose.rotation) {
        near(*component, *expected, "rotation");
    }
    let mut twists = Vec::new();
    let mut steepest = 1.0_f64;
    for joint in 0..JOINTS {
        near(state.outputs[joint], evaluation.output_rad(joint), "output");
        let slope = evaluation.output_slope(joint);
        near_beside(slope, state.output_slopes[joint], slope, "slope");
        steepest = steepest.max(slope.abs());
        let Twist { linear, angular } = state.jacobian[joint];
        let twist = evaluation.joint_twist(joint);
        all_near(&linear, &twist.linear, "linear part");
        all_near(&angular, &twist.angular, "angular part");
        twists.push(evaluation.reading_twist(joint));
    }
    let moment_nm = [0.1, -0.2, 0.3];
    let mut expected_nm = [0.0; JOINTS];
    let (force, moment) = (Vector3::from(force_n), Vector3::from(moment_nm));
    joint_torques_nm(&twists, &force, &moment, &mut expected_nm).unwrap();
    let torques_nm = state.reading_torques_nm(force_n, moment_nm).unwrap();
    for (torque_nm, expected_nm) in torques_nm.into_iter().zip(expected_nm) {
        near_beside(steepest, torque_nm, expected_nm, "torque");
    }
}

/// A device of one to seven joints, readings, a force; half of the devices with origins before rows.
fn any_case() -> impl Strategy<Value = (Device, Vec<f64>, [f64; 3])> {
    (1..=7_usize).prop_flat_map(|joints| {
        (
            prop_oneof![
                any_device(joints).boxed(),
                any_general_device(joints, joints).boxed()
            ],
            vec(-1.2..1.2_f64, joints),
            any_force_n(),
        )
    })
}

fn any_force_n() -> impl Strategy<Value = [f64; 3]> {
    [-10.0..10.0_f64, -10.0..10.0_f64, -10.0..10.0_f64]
}

/// A device of two joints that drive three or five rows, in any order.
fn any_coupled_case() -> impl Strategy<Value = (Device, Vec<f64>, [f64; 3])> {
    prop_oneof![Just(3_usize), Just(5)].prop_flat_map(|rows| {
        let device = (any_general_device(2, rows), any_drives(2, rows));
        let device = device.prop_map(|(device, drives)| Device { drives, ..device });
        (device, vec(-1.2..1.2_f64, 2), any_force_n())
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn every_device_at_every_reading((device, readings, force_n) in any_case()) {
        match device.joints.len() {
            1 => compare::<1>(&device, &readings, force_n),
            2 => compare::<2>(&device, &readings, force_n),
            3 => compare::<3>(&device, &readings, force_n),
            4 => compare::<4>(&device, &readings, force_n),
            5 => compare::<5>(&device, &readings, force_n),
            6 => compare::<6>(&device, &readings, force_n),
            _ => compare::<7>(&device, &readings, force_n),
        }
    }

    #[test]
    fn every_device_with_rows_that_follow((device, readings, force_n) in any_coupled_case()) {
        match device.drives.len() {
            3 => compare_coupled::<2, 3>(&device, &readings, force_n),
            _ => compare_coupled::<2, 5>(&device, &readings, force_n),
        }
    }
}
