//! Forces through a wrong Jacobian, by virtual work and by closed forms.

use haptical_model::kinematics::nalgebra::{Matrix6, Vector6};
use haptical_model::{Device, Evaluation, ForceTransmission, ModelError, TransmissionError};
use haptical_testkit::haptic7;

const FREE: [usize; 6] = [0, 1, 3, 4, 5, 6];
const POSTURE: [f64; 7] = [0.2, -0.3, 0.0, 0.25, 0.4, 0.3, -0.5];

fn at(device: &Device) -> Evaluation<'_> {
    let mut evaluation = Evaluation::new(device);
    evaluation.move_to(&POSTURE).unwrap();
    evaluation
}

/// A device that differs in lengths, twists and ratios.
fn other() -> Device {
    let mut other = haptic7();
    other.links[3].alpha_rad += 0.02;
    other.links[5].d_m += 3e-3;
    other.links[7].theta_rad -= 0.03;
    if let TransmissionError::Capstan(error) = &mut other.joints[1].transmission_error {
        error.ratio_deviation = 0.2;
        error.output_drum_xy_m = [1e-3, -5e-4];
    }
    other
}

#[test]
fn joint_torques_do_the_same_work_on_both_devices() {
    let (truth, controller) = (other(), haptic7());
    let (truth, controller) = (at(&truth), at(&controller));
    let found = ForceTransmission::new(&truth, &controller, FREE).unwrap();
    let wanted = Vector6::new(0.3, -1.0, 2.0, 0.02, -0.01, 0.05);
    let wrench = found.wrench(&wanted);
    // torque by torque: what the controller commands is what the true wrench needs
    for joint in FREE {
        let torque = |evaluation: &Evaluation<'_>, w: &Vector6<f64>| {
            let twist = evaluation.reading_twist(joint);
            (0..3)
                .map(|axis| twist.linear[axis] * w[axis] + twist.angular[axis] * w[axis + 3])
                .sum::<f64>()
        };
        let (commanded, needed) = (torque(&controller, &wanted), torque(&truth, &wrench));
        assert!(
            (commanded - needed).abs() < 1e-12,
            "joint {joint}: {commanded} {needed}"
        );
    }
    // a transposed or inverted Jacobian would give another wrench altogether
    assert!((wrench - wanted).norm() / wanted.norm() < 0.5);
    assert!((wrench - wanted).norm() / wanted.norm() > 1e-3);
}

/// The handle's work over a small motion is that of the motors: the energy that goes in comes out.
#[test]
fn virtual_work_over_a_small_motion_balances() {
    let truth_device = other();
    let controller_device = haptic7();
    let found = ForceTransmission::new(&at(&truth_device), &at(&controller_device), FREE).unwrap();
    let wanted = Vector6::new(1.0, 0.5, -2.0, 0.0, 0.0, 0.0);
    let wrench = found.wrench(&wanted);
    let controller = at(&controller_device);
    let step = [1e-6, -2e-6, 0.0, 1.5e-6, 1e-6, -1e-6, 2e-6];
    let mut work_in = 0.0;
    for joint in FREE {
        let twist = controller.reading_twist(joint);
        let force = Vector6::new(
            twist.linear.x,
            twist.linear.y,
            twist.linear.z,
            twist.angular.x,
            twist.angular.y,
            twist.angular.z,
        );
        work_in += force.dot(&wanted) * step[joint];
    }
    let place = |sign: f64| {
        let mut evaluation = Evaluation::new(&truth_device);
        let readings: Vec<f64> = POSTURE
            .iter()
            .zip(step)
            .map(|(q, dq)| q + 0.5 * sign * dq)
            .collect();
        evaluation.move_to(&readings).unwrap();
        *evaluation.pose().unwrap()
    };
    let (before, after) = (place(-1.0), place(1.0));
    let moved = after.position_m - before.position_m;
    let turned = after.rotation * before.rotation.transpose();
    let angle = [
        0.5 * (turned[(2, 1)] - turned[(1, 2)]),
        0.5 * (turned[(0, 2)] - turned[(2, 0)]),
        0.5 * (turned[(1, 0)] - turned[(0, 1)]),
    ];
    let work_out: f64 = (0..3)
        .map(|axis| wrench[axis] * moved[axis] + wrench[axis + 3] * angle[axis])
        .sum();
    assert!(
        (work_in - work_out).abs() < 1e-6 * work_in.abs(),
        "{work_in} {work_out}"
    );
    assert!(work_in.abs() > 1e-7);
}

#[test]
fn a_ratio_alone_scales_the_torque_of_its_joint() {
    let controller = haptic7();
    let mut truth = haptic7();
    if let TransmissionError::Capstan(error) = &mut truth.joints[0].transmission_error {
        error.ratio_deviation = -0.4;
    }
    // joint 1 turns by R / (R + R_e) = 8 / 7.6 of its reading, and there: the same pose
    let (known, mut true_at) = (at(&controller), Evaluation::new(&truth));
    let mut readings = POSTURE;
    readings[0] *= 7.6 / 8.0;
    true_at.move_to(&readings).unwrap();
    assert!((true_at.output_rad(0) - POSTURE[0]).abs() < 1e-12);
    let found = ForceTransmission::new(&true_at, &known, FREE).unwrap();
    // J_true = Jhat diag(8 / 7.6, 1, ...): M^T = Jhat diag(7.6 / 8, 1, ..) Jhat^-1 has that eigenvalue
    let mut values: Vec<f64> = found
        .matrix
        .complex_eigenvalues()
        .iter()
        .map(|value| value.re)
        .collect();
    values.sort_by(f64::total_cmp);
    assert!((values[0] - 0.95).abs() < 1e-9, "{values:?}");
    assert!(
        values[1..].iter().all(|value| (value - 1.0).abs() < 1e-6),
        "{values:?}"
    );
}

#[test]
fn the_loop_removes_the_error_as_the_gain_grows() {
    let (truth, controller) = (other(), haptic7());
    let found = ForceTransmission::new(&at(&truth), &at(&controller), FREE).unwrap();
    let wanted = Vector6::new(0.0, 0.0, 2.0, 0.0, 0.0, 0.0);
    let error = |gain: f64| (found.wrench_in_loop(&wanted, gain).unwrap() - wanted).norm();
    let open = (found.wrench(&wanted) - wanted).norm();
    assert!((error(0.0) - open).abs() < 1e-12);
    // (1 + G M)^-1 (1 + G) M - 1 = (1 + G M)^-1 (M - 1)
    let closed = (Matrix6::identity() + found.matrix * 3.0)
        .try_inverse()
        .unwrap()
        * (found.matrix - Matrix6::identity())
        * wanted;
    assert!((error(3.0) - closed.norm()).abs() < 1e-12);
    assert!(error(3.0) < 0.5 * open && error(100.0) < 0.05 * open);
}

#[test]
fn singular_postures_and_absent_joints_are_refused() {
    let device = haptic7();
    let mut evaluation = Evaluation::new(&device);
    assert!(matches!(
        ForceTransmission::new(&evaluation, &evaluation.clone(), FREE),
        Err(ModelError::NoLinks { .. })
    ));
    evaluation.move_to(&POSTURE).unwrap();
    let twice = [0, 0, 3, 4, 5, 6];
    assert!(matches!(
        ForceTransmission::new(&evaluation, &evaluation.clone(), twice),
        Err(ModelError::Posture { .. })
    ));
    assert_eq!(
        ForceTransmission::new(&evaluation, &evaluation.clone(), [0, 1, 3, 4, 5, 7]),
        Err(ModelError::NoJoint {
            joint: 8,
            joints: 7
        })
    );
}
