//! Gives wrong, infinite and huge input, and reads the refusal.

use haptical_kinematics::nalgebra::{Matrix3, Vector3};
use haptical_kinematics::{
    Chain, Convention, KinematicsError, Link, LinkDerivatives, Motion, Parameter, Pose, Twist,
    distance_derivative, distance_m, joint_torques_nm,
};
use proptest::prelude::*;

use crate::support::{CASES, convention};

const LINKS: [Link; 3] = [Link {
    a_m: 0.1,
    alpha_rad: 0.2,
    d_m: 0.3,
    theta_rad: 0.4,
    beta_rad: 0.5,
    b_m: 0.6,
}; 3];
const MOTIONS: [Motion; 3] = [Motion::Revolute, Motion::Fixed, Motion::Prismatic];

fn chain() -> Chain<'static> {
    Chain::new(Convention::Standard, &LINKS, &MOTIONS).unwrap()
}

#[test]
fn a_chain_needs_rows_and_one_motion_each() {
    let new = |links, motions| Chain::new(Convention::Standard, links, motions).unwrap_err();
    assert_eq!(new(&[], &[]), KinematicsError::EmptyChain);
    assert_eq!(
        new(&LINKS, &MOTIONS[..2]),
        KinematicsError::RowCount {
            links: 3,
            motions: 2
        }
    );
}

#[test]
fn a_parameter_that_is_not_finite_is_named() {
    for parameter in Parameter::ALL {
        let mut links = LINKS;
        links[2].set(parameter, f64::INFINITY);
        let error = Chain::new(Convention::Modified, &links, &MOTIONS).unwrap_err();
        let value = f64::INFINITY;
        assert_eq!(
            error,
            KinematicsError::NonFiniteParameter {
                row: 2,
                parameter,
                value
            }
        );
    }
    let mut links = LINKS;
    links[1].beta_rad = f64::NAN;
    let error = Chain::new(Convention::Modified, &links, &MOTIONS).unwrap_err();
    assert_eq!(
        error.to_string(),
        "row 1: beta is NaN; a finite number of rad is needed"
    );
}

#[test]
fn a_joint_that_is_not_finite_is_named() {
    let expected = KinematicsError::NonFiniteJoint {
        joint: 1,
        row: 2,
        value: f64::INFINITY,
    };
    let joints = [0.0, f64::INFINITY];
    assert_eq!(chain().pose(&joints).unwrap_err(), expected);
    let mut derivatives = [LinkDerivatives::default(); 3];
    assert_eq!(
        chain().derivatives(&joints, &mut derivatives).unwrap_err(),
        expected
    );
    let mut jacobian = [Twist::default(); 2];
    assert_eq!(
        chain()
            .geometric_jacobian(&joints, &mut jacobian)
            .unwrap_err(),
        expected
    );
    let error = chain().pose(&[f64::NAN, 0.0]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "joint 0 (row 0) is NaN; a finite number is needed"
    );
}

#[test]
fn counts_and_lengths_are_checked() {
    assert_eq!(chain().joint_count(), 2);
    for got in [0, 1, 3] {
        let error = chain().pose(&[0.0; 3][..got]).unwrap_err();
        assert_eq!(error, KinematicsError::JointCount { expected: 2, got });
    }
    let mut derivatives = [LinkDerivatives::default(); 4];
    let mut jacobian = [Twist::default(); 3];
    for result in [
        chain().derivatives(&[0.0; 2], &mut derivatives),
        chain().derivatives(&[0.0; 2], &mut derivatives[..2]),
        chain().geometric_jacobian(&[0.0; 2], &mut jacobian),
        chain().geometric_jacobian(&[0.0; 2], &mut jacobian[..1]),
    ] {
        assert!(matches!(result, Err(KinematicsError::BufferLength { .. })));
    }
    let zero = Vector3::zeros();
    let error = joint_torques_nm(&jacobian, &zero, &zero, &mut [0.0; 2]).unwrap_err();
    assert!(matches!(
        error,
        KinematicsError::BufferLength {
            expected: 3,
            got: 2,
            ..
        }
    ));
}

#[test]
fn the_distance_refuses_the_anchor_itself() {
    let position = Vector3::new(0.1, -0.2, 0.3);
    let zero_distance = KinematicsError::ZeroDistance {
        position_m: position.into(),
    };
    assert_eq!(distance_m(&position, &position).unwrap_err(), zero_distance);
    let pose = Pose {
        position_m: position,
        ..Pose::default()
    };
    let error = distance_derivative(&pose, &position, &Twist::default()).unwrap_err();
    assert_eq!(error, zero_distance);
}

#[test]
fn the_distance_keeps_tiny_and_huge_separations() {
    for scale in [1e-300, 1e-160, 1.0, 1e160, 1e300] {
        let position_m = Vector3::new(2.0, 3.0, 6.0) * scale;
        let distance = distance_m(&position_m, &Vector3::zeros()).unwrap();
        assert!((distance / scale - 7.0).abs() < 1e-14);
        let twist = Twist {
            linear: Vector3::y(),
            angular: Vector3::zeros(),
        };
        let pose = Pose {
            position_m,
            ..Pose::default()
        };
        let derivative = distance_derivative(&pose, &Vector3::zeros(), &twist).unwrap();
        assert!((derivative - 3.0 / 7.0).abs() < 1e-15);
    }
}

#[test]
fn vectors_that_are_not_finite_are_refused() {
    let bad = Vector3::new(0.0, f64::NAN, 0.0);
    let good = Vector3::new(1.0, 2.0, 3.0);
    let refused = |result: Result<f64, KinematicsError>| {
        assert!(matches!(
            result,
            Err(KinematicsError::NonFiniteVector { .. })
        ));
    };
    refused(distance_m(&bad, &good));
    refused(distance_m(&good, &bad));
    let pose = Pose {
        position_m: good,
        ..Pose::default()
    };
    let twist = Twist {
        linear: bad,
        angular: good,
    };
    refused(distance_derivative(&pose, &Vector3::zeros(), &twist));
    let mut out = [0.0];
    let column = Twist {
        linear: good,
        angular: good,
    };
    for (column, force, moment) in [
        (column, bad, good),
        (column, good, bad),
        (twist, good, good),
        (
            Twist {
                linear: good,
                angular: bad,
            },
            good,
            good,
        ),
    ] {
        refused(joint_torques_nm(&[column], &force, &moment, &mut out).map(|()| 0.0));
    }
    let huge = Vector3::new(1e200, 1e200, 0.0);
    let column = Twist {
        linear: huge,
        angular: good,
    };
    let error = joint_torques_nm(&[column], &huge, &good, &mut out).unwrap_err();
    assert_eq!(
        error,
        KinematicsError::Overflow {
            quantity: "a joint torque"
        }
    );
}

#[test]
fn sums_and_positions_beyond_the_range_are_refused() {
    let links = [Link {
        theta_rad: f64::MAX,
        ..Link::default()
    }];
    let chain = Chain::new(Convention::Standard, &links, &[Motion::Revolute]).unwrap();
    let error = chain.pose(&[f64::MAX]).unwrap_err();
    assert!(matches!(
        error,
        KinematicsError::JointOverflow {
            joint: 0,
            row: 0,
            ..
        }
    ));

    let links = [
        LINKS[0],
        Link {
            a_m: 1e151,
            ..Link::default()
        },
    ];
    let chain = Chain::new(Convention::Standard, &links, &[Motion::Fixed; 2]).unwrap();
    let error = chain.pose(&[]).unwrap_err();
    assert!(matches!(
        error,
        KinematicsError::PositionOutOfRange { row: 1, .. }
    ));
}

fn any_finite() -> impl Strategy<Value = f64> {
    use prop::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    prop_oneof![
        POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO,
        -10.0..10.0_f64,
        -1e149..1e149_f64
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]

    #[test]
    fn every_finite_input_gives_finite_numbers_or_a_refusal(
        convention in convention(),
        numbers in prop::collection::vec(any_finite(), 18),
        joints in prop::array::uniform2(any_finite()),
    ) {
        let links: Vec<_> = numbers
            .chunks(6)
            .map(|n| Link { a_m: n[0], alpha_rad: n[1], d_m: n[2], theta_rad: n[3], beta_rad: n[4], b_m: n[5] })
            .collect();
        let chain = Chain::new(convention, &links, &MOTIONS).unwrap();
        let mut out = [LinkDerivatives::default(); 3];
        if let Ok(pose) = chain.derivatives(&joints, &mut out) {
            prop_assert!(pose.position_m.iter().chain(&pose.rotation).all(|x| x.is_finite()));
            for parameter in Parameter::ALL {
                for twist in out.map(|link| link.get(parameter)) {
                    prop_assert!(twist.linear.iter().chain(&twist.angular).all(|x| x.is_finite()));
                    if let Ok(rate) = distance_derivative(&pose, &Vector3::zeros(), &twist) {
                        prop_assert!(rate.is_finite());
                    }
                }
            }
        }
    }
}

/// Each defect alone is enough: too far, stretched, mirrored, not a number.
#[test]
fn an_origin_that_is_no_place_is_refused() {
    let rigid = Pose {
        rotation: Matrix3::identity(),
        position_m: Vector3::new(0.1, -0.2, 0.3),
    };
    let with = |change: &dyn Fn(&mut Pose)| {
        let mut origin = rigid;
        change(&mut origin);
        let origins = [None, Some(origin)];
        Chain::with_origins(Convention::Standard, &LINKS, &MOTIONS, &origins).map(|_| ())
    };
    assert_eq!(with(&|_| {}), Ok(()));
    let refused = Err(KinematicsError::Origin { row: 1 });
    assert_eq!(with(&|origin| origin.position_m.y = 1e151), refused);
    assert_eq!(with(&|origin| origin.position_m.z = f64::NAN), refused);
    assert_eq!(with(&|origin| origin.rotation[(0, 0)] = 1.001), refused);
    assert_eq!(with(&|origin| origin.rotation[(2, 2)] = -1.0), refused);
    assert_eq!(with(&|origin| origin.rotation[(0, 1)] = f64::NAN), refused);
}
