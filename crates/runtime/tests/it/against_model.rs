//! Every number of a step against `haptical_model::Evaluation`, which computes it from `libm` row by
//! row.

use haptical_model::kinematics::{joint_torques_nm, nalgebra::Vector3};
use haptical_model::{Device, Evaluation};
use haptical_runtime::Twist;
use proptest::collection::vec;
use proptest::prelude::*;

use crate::devices::{any_device, model};

/// Numbers here are of the size of 1; both sides round some hundred times.
const TOLERANCE: f64 = 1e-12;

fn near(ours: f64, theirs: f64, what: &str) {
    // Not `>`: NaN must fail as well.
    let is_near = (ours - theirs).abs() <= TOLERANCE * theirs.abs().max(1.0);
    assert!(is_near, "{what}: {ours:?} here, {theirs:?} there");
}

fn all_near(ours: [f64; 3], theirs: &Vector3<f64>, what: &str) {
    for (ours, theirs) in ours.into_iter().zip(theirs.iter()) {
        near(ours, *theirs, what);
    }
}

/// A step of both, and every number compared; refusals must agree too.
pub(crate) fn compare<const JOINTS: usize>(device: &Device, readings: &[f64], force_n: [f64; 3]) {
    let readings: [f64; JOINTS] = std::array::from_fn(|joint| readings[joint]);
    let mut evaluation = Evaluation::new(device);
    let theirs = evaluation.move_to(&readings);
    let ours = model::<JOINTS>(device).step(&readings);
    let (Ok(()), Ok(state)) = (&theirs, &ours) else {
        assert!(
            theirs.is_err() && ours.is_err(),
            "{theirs:?} there, {ours:?} here"
        );
        return;
    };
    let pose = evaluation.pose().unwrap();
    all_near(state.position_m, &pose.position_m, "position");
    for (row, axes) in state.rotation.iter().enumerate() {
        for (column, component) in axes.iter().enumerate() {
            near(*component, pose.rotation[(row, column)], "rotation");
        }
    }
    let mut twists = Vec::new();
    for joint in 0..JOINTS {
        near(state.outputs[joint], evaluation.output_rad(joint), "output");
        near(
            state.output_slopes[joint],
            evaluation.output_slope(joint),
            "slope",
        );
        let Twist { linear, angular } = state.jacobian[joint];
        let twist = evaluation.joint_twist(joint);
        all_near(linear, &twist.linear, "linear part");
        all_near(angular, &twist.angular, "angular part");
        twists.push(evaluation.reading_twist(joint));
    }
    let moment_nm = [0.1, -0.2, 0.3];
    let mut expected_nm = [0.0; JOINTS];
    let (force, moment) = (Vector3::from(force_n), Vector3::from(moment_nm));
    joint_torques_nm(&twists, &force, &moment, &mut expected_nm).unwrap();
    let torques_nm = state.reading_torques_nm(force_n, moment_nm).unwrap();
    for (torque_nm, expected_nm) in torques_nm.into_iter().zip(expected_nm) {
        near(torque_nm, expected_nm, "torque");
    }
}

/// A device of one to seven joints, readings, a force.
fn any_case() -> impl Strategy<Value = (Device, Vec<f64>, [f64; 3])> {
    (1..=7_usize).prop_flat_map(|joints| {
        (
            any_device(joints),
            vec(-1.2..1.2_f64, joints),
            [-10.0..10.0_f64, -10.0..10.0_f64, -10.0..10.0_f64],
        )
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
}
