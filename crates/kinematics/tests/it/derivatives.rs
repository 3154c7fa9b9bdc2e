//! Compares every derivative of random chains with central differences.

use haptical_kinematics::nalgebra::Vector3;
use haptical_kinematics::{Motion, Parameter, distance_derivative, distance_m, joint_torques_nm};
use proptest::prelude::*;

use crate::support::{CASES, Case, ROUNDING, case, convention, five_point, gap, pose_gap};
use crate::support::{small_rotation_vector, twist_gap};

/// Step of the differences, in m or rad: rounding of a 10 m position over the step is 1e-11, the
/// five-point formula's own error is step^4/30 times the fifth derivative, 5e-16.
const STEP: f64 = 2e-4;

/// Rounding over the step, with a factor of ten, in m per m or per rad.
const POSITION: f64 = 1e-10;

/// Rounding of a rotation over the step, with a factor of ten, in rad per m or per rad.
const ORIENTATION: f64 = 1e-10;

/// The distance's fifth derivative by an angle is at most of the order reach^5 / distance^4, 10^6 m
/// for 10 m and the smallest distance admitted below: step^4/30 times that is 5e-11, and the
/// derivative's own coefficients reach a hundred.
const DISTANCE: f64 = 1e-8;

/// Smallest distance to the anchor at which the distance's derivative is differenced, in m.
const SMALLEST_DISTANCE_M: f64 = 0.5;

fn anchor() -> impl Strategy<Value = Vector3<f64>> {
    let coordinate = || -1.0..1.0_f64;
    prop_oneof![
        Just(Vector3::zeros()),
        (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| Vector3::new(x, y, z)),
    ]
}

/// Rotation vector from the pose one step before to the pose one step after, per unit.
fn difference_of_orientation(before: &Case, after: &Case, step: f64) -> Vector3<f64> {
    let change = after.pose().rotation * before.pose().rotation.transpose();
    small_rotation_vector(&change) / (2.0 * step)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]

    #[test]
    fn parameter_derivatives_match_differences(case in case(convention())) {
        let derivatives = case.derivatives();
        for (row, link) in derivatives.iter().enumerate() {
            for parameter in Parameter::ALL {
                let at = |step| case.moved(row, parameter, step);
                let linear = five_point(STEP, |step| at(step).pose().position_m);
                let angular = difference_of_orientation(&at(-STEP), &at(STEP), STEP);
                let twist = link.get(parameter);
                prop_assert!(gap(&twist.linear, &linear) < POSITION, "row {row} {parameter}");
                prop_assert!(gap(&twist.angular, &angular) < ORIENTATION, "row {row} {parameter}");
            }
        }
    }

    #[test]
    fn joint_derivatives_match_differences(case in case(convention())) {
        let jacobian = case.jacobian();
        for (joint, twist) in jacobian.iter().enumerate() {
            let at = |step: f64| {
                let mut moved = case.clone();
                moved.joints[joint] += step;
                moved
            };
            let linear = five_point(STEP, |step| at(step).pose().position_m);
            let angular = difference_of_orientation(&at(-STEP), &at(STEP), STEP);
            prop_assert!(gap(&twist.linear, &linear) < POSITION, "joint {joint}");
            prop_assert!(gap(&twist.angular, &angular) < ORIENTATION, "joint {joint}");
        }
    }

    #[test]
    fn distance_derivatives_match_differences(case in case(convention()), anchor_m in anchor()) {
        let pose = case.pose();
        prop_assume!((pose.position_m - anchor_m).norm() > SMALLEST_DISTANCE_M);
        let distance = distance_m(&pose.position_m, &anchor_m).unwrap();
        prop_assert!((distance - (pose.position_m - anchor_m).norm()).abs() < ROUNDING);
        for (row, link) in case.derivatives().iter().enumerate() {
            for parameter in Parameter::ALL {
                let numeric = five_point(STEP, |step| {
                    let moved = case.moved(row, parameter, step).pose().position_m;
                    Vector3::new(distance_m(&moved, &anchor_m).unwrap(), 0.0, 0.0)
                });
                let exact = distance_derivative(&pose, &anchor_m, &link.get(parameter)).unwrap();
                prop_assert!((exact - numeric.x).abs() < DISTANCE, "row {row} {parameter}");
            }
        }
    }

    /// The three entry points walk the same chain, so they must not differ at all.
    #[test]
    fn entry_points_agree(case in case(convention())) {
        let mut derivatives = case.derivatives();
        let from_derivatives = case.chain().derivatives(&case.joints, &mut derivatives).unwrap();
        let mut jacobian = case.jacobian();
        let from_jacobian = case.chain().geometric_jacobian(&case.joints, &mut jacobian).unwrap();
        prop_assert_eq!(from_derivatives, case.pose());
        prop_assert_eq!(from_jacobian, case.pose());
        let by_row = derivatives.iter().zip(&case.motions);
        let columns: Vec<_> = by_row.filter_map(|(link, motion)| link.joint(*motion)).collect();
        prop_assert_eq!(columns, jacobian);
    }

    /// Power at the joints equals power at the handle, `tau . qdot = F . v + M . omega`, with the
    /// velocities taken from differences of the pose along the joints' motion, not from `J`.
    #[test]
    fn power_is_the_same_at_joints_and_handle(
        case in case(convention()),
        rates in prop::collection::vec(-1.0..1.0_f64, 10),
        force_n in prop::array::uniform3(-5.0..5.0_f64),
        moment_nm in prop::array::uniform3(-1.0..1.0_f64),
    ) {
        /// 20 N and Nm together, times the error of the differenced velocities of ten joints, whose
        /// fifth derivatives reach 10^5 times the reach of 10 m.
        const POWER_W: f64 = 1e-7;
        let (force_n, moment_nm) = (Vector3::from(force_n), Vector3::from(moment_nm));
        let mut torques = vec![0.0; case.joints.len()];
        joint_torques_nm(&case.jacobian(), &force_n, &moment_nm, &mut torques).unwrap();
        let at_joints: f64 = torques.iter().zip(&rates).map(|(torque, rate)| torque * rate).sum();

        let at = |time: f64| {
            let mut moved = case.clone();
            for (joint, rate) in moved.joints.iter_mut().zip(&rates) {
                *joint += rate * time;
            }
            moved
        };
        let velocity = five_point(STEP, |time| at(time).pose().position_m);
        let turned = |time: f64| {
            let change = at(time).pose().rotation * case.pose().rotation.transpose();
            small_rotation_vector(&change)
        };
        let angular_velocity = five_point(STEP, turned);
        let at_handle = force_n.dot(&velocity) + moment_nm.dot(&angular_velocity);
        prop_assert!((at_joints - at_handle).abs() < POWER_W, "{at_joints} {at_handle}");
    }

    /// A joint value and its parameter are added, so they may be exchanged.
    #[test]
    fn joint_value_is_added_to_its_parameter(case in case(convention())) {
        let mut shifted = case.clone();
        let mut joints = case.joints.iter();
        for (link, motion) in shifted.links.iter_mut().zip(&case.motions) {
            match motion {
                Motion::Fixed => {}
                Motion::Revolute => link.theta_rad += joints.next().unwrap(),
                Motion::Prismatic => link.d_m += joints.next().unwrap(),
            }
        }
        shifted.joints.fill(0.0);
        prop_assert!(pose_gap(&case.pose(), &shifted.pose()) < ROUNDING);
        for (left, right) in case.jacobian().iter().zip(&shifted.jacobian()) {
            prop_assert!(twist_gap(left, right) < ROUNDING);
        }
    }
}
