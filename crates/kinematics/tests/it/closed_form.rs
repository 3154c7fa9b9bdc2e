//! Compares with formulas worked out by hand.

use std::f64::consts::{FRAC_PI_2, TAU};

use haptical_kinematics::nalgebra::{Matrix3, Vector3};
use haptical_kinematics::{Convention, Link, Motion, Parameter, Pose, Twist, joint_torques_nm};
use proptest::prelude::*;

use crate::support::{CASES, Case, ROUNDING, case, convention, gap, homogeneous_product, pose_gap};
use crate::support::{rotation_x, rotation_y, rotation_z, twist_gap};

const LINK: Link = Link {
    a_m: 0.31,
    alpha_rad: 0.7,
    d_m: -0.23,
    theta_rad: 1.9,
    beta_rad: -0.4,
    b_m: 0.17,
};

fn single(convention: Convention) -> Case {
    Case {
        convention,
        links: vec![LINK],
        motions: vec![Motion::Fixed],
        joints: vec![],
        origins: Vec::new(),
    }
}

#[test]
fn parameters_have_names_units_and_values() {
    let described = Parameter::ALL.map(|p| (p.name(), p.unit(), LINK.get(p)));
    let expected = [
        ("a", "m", LINK.a_m),
        ("alpha", "rad", LINK.alpha_rad),
        ("d", "m", LINK.d_m),
        ("theta", "rad", LINK.theta_rad),
        ("beta", "rad", LINK.beta_rad),
        ("b", "m", LINK.b_m),
    ];
    assert_eq!(described, expected);
    let mut link = Link::default();
    for parameter in Parameter::ALL {
        link.set(parameter, LINK.get(parameter));
    }
    assert_eq!(link, LINK);
}

#[test]
fn one_standard_row() {
    let (s, c) = LINK.theta_rad.sin_cos();
    let expected = Pose {
        position_m: Vector3::new(
            LINK.a_m * c - LINK.b_m * s,
            LINK.a_m * s + LINK.b_m * c,
            LINK.d_m,
        ),
        rotation: rotation_z(LINK.theta_rad)
            * rotation_x(LINK.alpha_rad)
            * rotation_y(LINK.beta_rad),
    };
    assert!(pose_gap(&single(Convention::Standard).pose(), &expected) < ROUNDING);
}

#[test]
fn one_modified_row() {
    let (sa, ca) = LINK.alpha_rad.sin_cos();
    let (sb, cb) = LINK.beta_rad.sin_cos();
    let expected = Pose {
        position_m: Vector3::new(LINK.a_m, LINK.b_m, 0.0)
            + Vector3::new(sb, -sa * cb, ca * cb) * LINK.d_m,
        rotation: rotation_x(LINK.alpha_rad)
            * rotation_y(LINK.beta_rad)
            * rotation_z(LINK.theta_rad),
    };
    assert!(pose_gap(&single(Convention::Modified).pose(), &expected) < ROUNDING);
}

#[test]
fn planar_arm_of_two_links() {
    let (l1, l2) = (0.35, 0.22);
    let case = Case {
        convention: Convention::Standard,
        links: [l1, l2]
            .map(|a_m| Link {
                a_m,
                ..Link::default()
            })
            .to_vec(),
        motions: vec![Motion::Revolute; 2],
        joints: vec![0.4, -1.3],
        origins: Vec::new(),
    };
    let (s1, c1) = case.joints[0].sin_cos();
    let (s12, c12) = (case.joints[0] + case.joints[1]).sin_cos();

    let position_m = Vector3::new(l1 * c1 + l2 * c12, l1 * s1 + l2 * s12, 0.0);
    let rotation = Matrix3::new(c12, -s12, 0.0, s12, c12, 0.0, 0.0, 0.0, 1.0);
    assert!(
        pose_gap(
            &case.pose(),
            &Pose {
                position_m,
                rotation
            }
        ) < ROUNDING
    );

    let jacobian = case.jacobian();
    let turn = |x, y| Twist {
        linear: Vector3::new(x, y, 0.0),
        angular: Vector3::z(),
    };
    assert!(twist_gap(&jacobian[0], &turn(-l1 * s1 - l2 * s12, l1 * c1 + l2 * c12)) < ROUNDING);
    assert!(twist_gap(&jacobian[1], &turn(-l2 * s12, l2 * c12)) < ROUNDING);

    // alpha_0 turns the second link about the first one: dP = x1 x (l2 x2) = l2 sin(theta_2) z
    let alpha = case.derivatives()[0].alpha;
    let expected = Twist {
        linear: Vector3::new(0.0, 0.0, l2 * case.joints[1].sin()),
        angular: Vector3::new(c1, s1, 0.0),
    };
    assert!(twist_gap(&alpha, &expected) < ROUNDING);
    // beta_0 turns it about y1: dP = y1 x (l2 x2) = -l2 cos(theta_2) z
    let beta = case.derivatives()[0].beta;
    let expected = Twist {
        linear: Vector3::new(0.0, 0.0, -l2 * case.joints[1].cos()),
        angular: Vector3::new(-s1, c1, 0.0),
    };
    assert!(twist_gap(&beta, &expected) < ROUNDING);

    // A force of 2 N along x and a moment of 0.3 Nm about z
    let mut torques_nm = [0.0; 2];
    let (force_n, moment_nm) = (Vector3::new(2.0, 0.0, 5.0), Vector3::new(7.0, 0.0, 0.3));
    joint_torques_nm(&jacobian, &force_n, &moment_nm, &mut torques_nm).unwrap();
    let expected = [2.0 * (-l1 * s1 - l2 * s12) + 0.3, 2.0 * -l2 * s12 + 0.3];
    assert!(gap(&torques_nm, &expected) < ROUNDING);
}

/// Two turns about perpendicular axes, then a slide: the end is at the spherical coordinates
/// azimuth `q1`, polar angle `q2`, radius `q3`.
fn spherical_arm(convention: Convention, joints: [f64; 3]) -> Case {
    let alphas = match convention {
        // the row's own twist leads to the next axis
        Convention::Standard => [-FRAC_PI_2, FRAC_PI_2, 0.0],
        // the row's own twist leads to its own axis
        Convention::Modified => [0.0, -FRAC_PI_2, FRAC_PI_2],
    };
    Case {
        convention,
        links: alphas
            .map(|alpha_rad| Link {
                alpha_rad,
                ..Link::default()
            })
            .to_vec(),
        motions: vec![Motion::Revolute, Motion::Revolute, Motion::Prismatic],
        joints: joints.to_vec(),
        origins: Vec::new(),
    }
}

#[test]
fn spherical_arm_in_both_conventions() {
    let (q1, q2, q3) = (0.8_f64, 1.1_f64, 0.45);
    let (s1, c1) = q1.sin_cos();
    let (s2, c2) = q2.sin_cos();
    let position = Vector3::new(c1 * s2, s1 * s2, c2) * q3;
    let columns = [
        Twist {
            linear: Vector3::new(-s1 * s2, c1 * s2, 0.0) * q3,
            angular: Vector3::z(),
        },
        Twist {
            linear: Vector3::new(c1 * c2, s1 * c2, -s2) * q3,
            angular: Vector3::new(-s1, c1, 0.0),
        },
        Twist {
            linear: Vector3::new(c1 * s2, s1 * s2, c2),
            angular: Vector3::zeros(),
        },
    ];
    for convention in [Convention::Standard, Convention::Modified] {
        let case = spherical_arm(convention, [q1, q2, q3]);
        assert!(gap(&case.pose().position_m, &position) < ROUNDING);
        for (column, expected) in case.jacobian().iter().zip(&columns) {
            assert!(twist_gap(column, expected) < ROUNDING, "{convention:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]

    #[test]
    fn pose_is_the_product_of_the_rows_matrices(case in case(convention())) {
        let product = homogeneous_product(&case);
        let expected = Pose {
            position_m: product.fixed_view::<3, 1>(0, 3).into_owned(),
            rotation: product.fixed_view::<3, 3>(0, 0).into_owned(),
        };
        prop_assert!(pose_gap(&case.pose(), &expected) < ROUNDING);
    }

    /// 159 turns are 999 rad. Adding them rounds each angle by half a unit in the last place of
    /// 1024, 1.1e-13 rad, and TAU's own error adds 159 times 2.4e-16; ten rows of 1 m reach 10 m.
    #[test]
    fn whole_turns_change_nothing(case in case(convention()), turns in -159..=159_i32) {
        const WHOLE_TURNS: f64 = 2e-11;
        let mut turned = case.clone();
        for link in &mut turned.links {
            for angle in [&mut link.alpha_rad, &mut link.theta_rad, &mut link.beta_rad] {
                *angle += f64::from(turns) * TAU;
            }
        }
        prop_assert!(pose_gap(&case.pose(), &turned.pose()) < WHOLE_TURNS);
        for (left, right) in case.derivatives().iter().zip(&turned.derivatives()) {
            for parameter in Parameter::ALL {
                prop_assert!(twist_gap(&left.get(parameter), &right.get(parameter)) < WHOLE_TURNS);
            }
        }
    }
}

/// Sines and cosines must not come from the platform, whose last bits differ between machines.
/// Two good implementations differ in few of many values, so the bits of many poses are mixed into
/// one number. This crate wrote that number; the product of matrices says that the poses are right.
#[test]
fn bits_do_not_depend_on_the_machine() {
    const WRITTEN: u64 = 0x5c0f_9735_44fb_6453;
    let mut mixed = 0_u64;
    for index in 0..2000_u32 {
        let joint = f64::from(index) * 0.515_625; // exact, up to 1030 rad
        let case = Case {
            convention: Convention::Standard,
            links: vec![Link { b_m: 0.0, ..LINK }; 3],
            motions: vec![Motion::Revolute, Motion::Prismatic, Motion::Revolute],
            joints: vec![joint, 0.125, 0.5 - joint],
            origins: Vec::new(),
        };
        let position_m = case.pose().position_m;
        let product = homogeneous_product(&case)
            .fixed_view::<3, 1>(0, 3)
            .into_owned();
        assert!(gap(&position_m, &product) < ROUNDING);
        for coordinate in position_m.iter() {
            mixed = mixed.rotate_left(7).wrapping_mul(0x100_0000_01b3) ^ coordinate.to_bits();
        }
    }
    assert_eq!(mixed, WRITTEN, "{mixed:#x}");
}
