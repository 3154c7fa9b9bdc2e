//! Predictions: closed forms, and every derivative against central differences.

use haptical_model::kinematics::nalgebra::Matrix3;
use haptical_model::kinematics::{Convention, Link, Pose, Twist};
use haptical_model::transmission::CapstanError;
use haptical_model::{
    Device, Evaluation, Joint, JointType, ModelError, ParameterId, TransmissionError,
};
use proptest::prelude::*;

use crate::support::{CASES, all_parameters, bends_near, device_and_readings};

/// Step of the central differences.
const STEP: f64 = 1e-6;
/// Their error: truncation STEP^2 f''' / 6 with f''' up to 2 / (0.003 m)^3 for the shortest input drum
/// denominator, 1e-5 of a derivative of 1 / 0.003 m; rounding 1e-16 / STEP. The bound is relative to
/// 1 + the derivative.
const DIFFERENCE: f64 = 1e-6;
/// Two ways to the same number: a dozen roundings of numbers up to 10.
const ROUNDING: f64 = 1e-14;

fn moved(device: &Device, readings: &[f64]) -> (Pose, Vec<f64>) {
    let mut at = Evaluation::new(device);
    at.move_to(readings).unwrap();
    let outputs = (0..device.joints.len())
        .map(|joint| at.output_rad(joint))
        .collect();
    (*at.pose().unwrap(), outputs)
}

/// Central difference of two poses: of the position, and of the rotation matrix.
fn check_twist(twist: &Twist, here: &Pose, plus: &Pose, minus: &Pose) -> Result<(), TestCaseError> {
    let scale = 1.0 + twist.linear.norm() + twist.angular.norm();
    let linear = (plus.position_m - minus.position_m) / (2.0 * STEP);
    let gap = (linear - twist.linear).norm();
    prop_assert!(
        gap < DIFFERENCE * scale,
        "linear {} {}",
        linear,
        twist.linear
    );
    let turned: Matrix3<f64> = (plus.rotation - minus.rotation) / (2.0 * STEP);
    let gap = (turned - twist.angular.cross_matrix() * here.rotation).norm();
    prop_assert!(
        gap < DIFFERENCE * scale,
        "angular {}: {gap:e}",
        twist.angular
    );
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]

    #[test]
    fn derivatives_with_respect_to_every_parameter((device, readings) in device_and_readings()) {
        let mut at = Evaluation::new(&device);
        at.move_to(&readings).unwrap();
        let here = *at.pose().unwrap();
        for id in all_parameters(&device) {
            let shifted = |step: f64| {
                let mut other = device.clone();
                id.set(&mut other, id.value(&device) + step);
                moved(&other, &readings)
            };
            let ((plus, outputs_plus), (minus, outputs_minus)) = (shifted(STEP), shifted(-STEP));
            check_twist(&at.pose_derivative(id), &here, &plus, &minus)
                .map_err(|error| TestCaseError::fail(format!("{}: {error}", id.name(&device))))?;
            for joint in 0..device.joints.len() {
                let slope = at.output_derivative(joint, id);
                let difference = (outputs_plus[joint] - outputs_minus[joint]) / (2.0 * STEP);
                prop_assert!(
                    (slope - difference).abs() < DIFFERENCE * (1.0 + slope.abs()),
                    "output {joint} by {}: {slope} {difference}", id.name(&device)
                );
            }
        }
    }

    #[test]
    fn derivatives_with_respect_to_every_reading((device, readings) in device_and_readings()) {
        let mut at = Evaluation::new(&device);
        at.move_to(&readings).unwrap();
        let here = *at.pose().unwrap();
        for (joint, reading) in readings.iter().enumerate() {
            let shifted = |step: f64| {
                let mut other = readings.clone();
                other[joint] += step;
                moved(&device, &other)
            };
            if bends_near(&device, joint, *reading, 2.0 * STEP) {
                continue;
            }
            let ((plus, outputs_plus), (minus, outputs_minus)) = (shifted(STEP), shifted(-STEP));
            check_twist(&at.reading_twist(joint), &here, &plus, &minus)?;
            let difference = (outputs_plus[joint] - outputs_minus[joint]) / (2.0 * STEP);
            prop_assert!((at.output_slope(joint) - difference).abs() < DIFFERENCE * (1.0 + difference.abs()));
            // the joint's own twist is what one rad of output does
            let scaled = at.joint_twist(joint).linear * at.output_slope(joint);
            prop_assert!((scaled - at.reading_twist(joint).linear).norm() < ROUNDING);
        }
    }

    #[test]
    fn the_output_is_the_reading_plus_the_error((device, readings) in device_and_readings()) {
        let mut at = Evaluation::new(&device);
        at.move_to(&readings).unwrap();
        for (joint, reading) in readings.iter().enumerate() {
            let error = device.joints[joint].error_rad(*reading).unwrap();
            prop_assert_eq!(at.error_rad(joint), error);
            prop_assert_eq!(at.output_rad(joint), reading + error);
        }
    }

    #[test]
    fn links_home_and_offset_do_not_move_an_output((device, readings) in device_and_readings()) {
        let (_, expected) = moved(&device, &readings);
        let mut other = device.clone();
        for joint in &mut other.joints {
            joint.home_rad += 0.3;
        }
        for id in device.link_parameters(true) {
            id.set(&mut other, 0.1);
        }
        prop_assert_eq!(moved(&other, &readings).1, expected);
    }

    #[test]
    fn home_theta_error_and_offset_add_up((device, readings) in device_and_readings()) {
        // the same pose with everything in theta_offset (or d) and nothing elsewhere
        let (pose, outputs) = moved(&device, &readings);
        let mut other = device.clone();
        for (index, joint) in other.joints.iter_mut().enumerate() {
            let row = &mut other.links[index + 1];
            match joint.joint_type {
                JointType::Revolute => row.theta_rad += joint.home_rad + outputs[index],
                JointType::Prismatic => row.d_m += joint.home_rad + outputs[index],
            }
            *joint = Joint { joint_type: joint.joint_type, ..Joint::default() };
        }
        let (same, _) = moved(&other, &vec![0.0; readings.len()]);
        prop_assert!((pose.position_m - same.position_m).norm() < ROUNDING);
        prop_assert!((pose.rotation - same.rotation).norm() < ROUNDING);
    }
}

fn offset_joint(joint_type: JointType) -> Joint {
    Joint {
        joint_type,
        home_rad: 0.5,
        transmission_error: TransmissionError::Capstan(CapstanError {
            offset_rad: 0.03,
            ..CapstanError::default()
        }),
        ..Joint::default()
    }
}

#[test]
fn the_angle_of_one_revolute_joint() {
    let link = Link {
        a_m: 0.2,
        theta_rad: 0.2,
        ..Link::default()
    };
    let joint = offset_joint(JointType::Revolute);
    let device = Device::new(
        Convention::Standard,
        vec![Link::default(), link],
        vec![joint],
    );
    let (pose, outputs) = moved(&device, &[0.1]);
    // 0.5 home + 0.1 reading + 0.03 error + 0.2 offset
    let (sin, cos) = 0.83_f64.sin_cos();
    assert!((pose.position_m.x - 0.2 * cos).abs() < ROUNDING);
    assert!((pose.position_m.y - 0.2 * sin).abs() < ROUNDING);
    assert!(
        (outputs[0] - 0.13).abs() < ROUNDING,
        "neither home nor offset is in it"
    );
}

#[test]
fn the_travel_of_one_prismatic_joint() {
    for convention in [Convention::Standard, Convention::Modified] {
        let link = Link {
            d_m: 0.2,
            ..Link::default()
        };
        let joint = offset_joint(JointType::Prismatic);
        let device = Device::new(convention, vec![Link::default(), link], vec![joint]);
        let (pose, outputs) = moved(&device, &[0.1]);
        assert!((pose.position_m.z - 0.83).abs() < ROUNDING);
        assert!((outputs[0] - 0.13).abs() < ROUNDING);
    }
}

#[test]
fn a_device_without_links_has_outputs_and_no_pose() {
    let joint = offset_joint(JointType::Revolute);
    let device = Device::new(Convention::Standard, Vec::new(), vec![joint]);
    let mut at = Evaluation::new(&device);
    at.move_to(&[0.1]).unwrap();
    assert!((at.output_rad(0) - 0.13).abs() < ROUNDING);
    let refused = at.pose().unwrap_err();
    assert_eq!(
        refused,
        ModelError::NoLinks {
            device: String::new()
        }
    );
}

#[test]
fn readings_of_the_wrong_number_or_without_a_value() {
    let series = Joint {
        transmission_error: TransmissionError::Chebyshev {
            range_rad: [-1.0, 1.0],
            coefficients: vec![0.0, 0.1],
        },
        ..Joint::default()
    };
    let links = vec![Link::default(); 3];
    for links in [links, Vec::new()] {
        let joints = vec![Joint::default(), series.clone()];
        let device = Device::new(Convention::Standard, links, joints);
        let mut at = Evaluation::new(&device);
        let count = ModelError::JointCount {
            expected: 2,
            found: 1,
        };
        assert_eq!(at.move_to(&[0.1]), Err(count));
        for bad in [f64::NAN, f64::INFINITY] {
            at.move_to(&[0.1, 0.2]).unwrap();
            let refused = at.move_to(&[0.1, bad]).unwrap_err();
            assert!(
                matches!(refused, ModelError::Transmission { joint: 2, .. }),
                "{refused}"
            );
            assert!(
                at.pose().is_err(),
                "no pose of readings before the refused ones"
            );
        }
    }
}

#[test]
fn a_parameter_of_another_joint_does_not_move_an_output() {
    let joints = vec![
        offset_joint(JointType::Revolute),
        offset_joint(JointType::Revolute),
    ];
    let device = Device::new(Convention::Standard, Vec::new(), joints);
    let mut at = Evaluation::new(&device);
    at.move_to(&[0.1, 0.2]).unwrap();
    let offset = |joint| ParameterId::Transmission { joint, index: 0 };
    assert_eq!(at.output_derivative(0, offset(0)), 1.0);
    assert_eq!(at.output_derivative(0, offset(1)), 0.0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]

    /// Outputs that were worked out before place the chain exactly where the readings do.
    #[test]
    fn outputs_place_the_chain_as_their_readings_do((device, readings) in device_and_readings()) {
        let (pose, outputs) = moved(&device, &readings);
        let mut at = Evaluation::new(&device);
        at.move_outputs(&outputs).unwrap();
        prop_assert_eq!(at.pose().unwrap(), &pose);
        for parameter in device.link_parameters(true) {
            let mut by_readings = Evaluation::new(&device);
            by_readings.move_to(&readings).unwrap();
            prop_assert_eq!(
                at.pose_derivative(parameter),
                by_readings.pose_derivative(parameter)
            );
        }
        let too_few = at.move_outputs(&outputs[1..]);
        prop_assert_eq!(
            too_few,
            Err(ModelError::JointCount { expected: outputs.len(), found: outputs.len() - 1 })
        );
    }
}
