//! Torques and slopes against differences of steps: virtual work, not the Jacobian's formula.

use haptical_runtime::{Model, RuntimeError};

use crate::exported::{identified, parallelogram};

/// Step of the central difference: its error is of the size of its square.
const STEP: f64 = 1e-5;
/// Size of that error times the third derivatives of the drums, which go with the ratio cubed.
const TOLERANCE: f64 = 1e-7;

const READINGS: [f64; 7] = [0.3, -0.2, 0.4, -0.5, 0.6, -0.7, 0.8];

fn work_is_virtual_work(model: &Model<7>) {
    let force_n = [1.5, -2.0, 0.7];
    let state = model.step(&READINGS).unwrap();
    let torques_nm = state.reading_torques_nm(force_n, [0.0; 3]).unwrap();
    let joint_torques_nm = state.joint_torques_nm(force_n, [0.0; 3]).unwrap();
    for joint in 0..7 {
        let at = |sign: f64| {
            let mut readings = READINGS;
            readings[joint] += sign * STEP;
            model.step(&readings).unwrap()
        };
        let (above, below) = (at(1.0), at(-1.0));
        let work: f64 = (0..3)
            .map(|axis| force_n[axis] * (above.pose.position_m[axis] - below.pose.position_m[axis]))
            .sum();
        assert!((work / (2.0 * STEP) - torques_nm[joint]).abs() < TOLERANCE);
        let slope = (above.outputs[joint] - below.outputs[joint]) / (2.0 * STEP);
        assert!((slope - state.output_slopes[joint]).abs() < TOLERANCE);
        // per unit of the output, not of the reading
        assert!((joint_torques_nm[joint] * slope - torques_nm[joint]).abs() < TOLERANCE);
    }
}

#[test]
fn the_torque_of_a_reading_is_the_work_per_reading() {
    work_is_virtual_work(&identified::MODEL);
    work_is_virtual_work(&parallelogram::MODEL);
}

#[test]
fn a_moment_turns_against_the_axes() {
    let state = identified::MODEL.step(&READINGS).unwrap();
    let moment_nm = [0.4, -0.1, 0.25];
    let torques_nm = state.joint_torques_nm([0.0; 3], moment_nm).unwrap();
    for (torque_nm, column) in torques_nm.into_iter().zip(state.jacobian) {
        let along: f64 = (0..3)
            .map(|axis| column.angular[axis] * moment_nm[axis])
            .sum();
        assert!((torque_nm - along).abs() < 1e-15);
        let length: f64 = column.angular.iter().map(|part| part * part).sum();
        assert!((length - 1.0).abs() < 1e-14);
    }
}

#[test]
fn forces_that_are_not_finite_or_too_large_are_refused() {
    let state = identified::MODEL.step(&READINGS).unwrap();
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let force = state.reading_torques_nm([0.0, value, 0.0], [0.0; 3]);
        assert!(matches!(
            force,
            Err(RuntimeError::NonFiniteWrench {
                quantity: "force",
                ..
            })
        ));
        let moment = state.joint_torques_nm([0.0; 3], [0.0, 0.0, value]);
        assert!(matches!(
            moment,
            Err(RuntimeError::NonFiniteWrench {
                quantity: "moment",
                ..
            })
        ));
    }
    let huge = state.joint_torques_nm([f64::MAX; 3], [f64::MAX; 3]);
    assert!(
        matches!(huge, Err(RuntimeError::TorqueOverflow { .. })),
        "{huge:?}"
    );
}
