//! The prepared chain against the chain it was prepared from, at ordinary, far and refused postures.

use haptical_kinematics::{
    Chain, Convention, KinematicsError, Link, Motion, Pose, PreparedChain, Twist,
};
use proptest::prelude::*;

use crate::support::{CASES, Case, case, convention, homogeneous_product, pose_gap, twist_gap};

/// Both ways round some 50 elementary motions and sines, for chains of at most 10 m: a few times 10 m
/// 2.2e-16. The largest gap of 20 000 random chains was 3.7e-15.
pub(crate) const PREPARED: f64 = 2e-14;

/// Pose and Jacobian by a prepared chain of as many joints as the case has.
pub(crate) fn prepared(case: &Case) -> Result<(Pose, Vec<Twist>), KinematicsError> {
    fn prepared<const JOINTS: usize>(case: &Case) -> Result<(Pose, Vec<Twist>), KinematicsError> {
        let chain = PreparedChain::<JOINTS>::new(&case.chain())?;
        let joints: &[f64; JOINTS] = case.joints.as_slice().try_into().unwrap();
        let mut jacobian = [Twist::default(); JOINTS];
        let pose = chain.pose_and_jacobian(joints, &mut jacobian)?;
        Ok((pose, jacobian.to_vec()))
    }
    match case.joints.len() {
        0 => prepared::<0>(case),
        1 => prepared::<1>(case),
        2 => prepared::<2>(case),
        3 => prepared::<3>(case),
        4 => prepared::<4>(case),
        5 => prepared::<5>(case),
        6 => prepared::<6>(case),
        7 => prepared::<7>(case),
        8 => prepared::<8>(case),
        9 => prepared::<9>(case),
        10 => prepared::<10>(case),
        joints => panic!("{joints} joints"),
    }
}

/// Largest gap between the prepared chain and the chain.
fn gap(case: &Case) -> f64 {
    let (pose, jacobian) = prepared(case).unwrap();
    let expected = case.jacobian();
    assert_eq!(jacobian.len(), expected.len());
    let columns = jacobian.iter().zip(&expected);
    columns
        .map(|(column, expected)| twist_gap(column, expected))
        .fold(pose_gap(&pose, &case.pose()), f64::max)
}

/// Every row at a multiple of a quarter turn: the twists whose Euler angles are not unique.
fn on_axes(convention: Convention, quarters: u32) -> Case {
    let motions = [
        Motion::Revolute,
        Motion::Fixed,
        Motion::Prismatic,
        Motion::Revolute,
    ];
    let quarter = |place: u32| f64::from(quarters >> (2 * place) & 3) * std::f64::consts::FRAC_PI_2;
    let links = std::array::from_fn::<_, 4, _>(|row| Link {
        a_m: 0.3,
        alpha_rad: quarter(row as u32),
        d_m: 0.2,
        theta_rad: quarter(row as u32 + 1),
        beta_rad: quarter(row as u32 + 2),
        b_m: 0.1,
    });
    Case {
        convention,
        links: links.to_vec(),
        motions: motions.to_vec(),
        joints: vec![0.4, -0.1, 0.9],
        origins: Vec::new(),
    }
}

/// Where rows need no turns of their own about z, none are made up; d goes to the row before.
#[test]
fn the_constants_of_plain_rows_are_the_rows_own() {
    for alpha_rad in [0.0_f64, 0.4, -1.5] {
        let (a_m, d_m) = (0.3, 0.2);
        let link = Link {
            a_m,
            alpha_rad,
            d_m,
            ..Link::default()
        };
        let links = [link; 2];
        let chain = Chain::new(Convention::Standard, &links, &[Motion::Revolute; 2]).unwrap();
        let prepared = PreparedChain::<2>::new(&chain).unwrap();
        let joints = prepared.constants().joints;
        for joint in joints {
            assert_eq!((joint.offset_rad, joint.x_m), (0.0, a_m));
            assert!((joint.twist_sine - alpha_rad.sin()).abs() < PREPARED);
            assert!((joint.twist_cosine - alpha_rad.cos()).abs() < PREPARED);
        }
        assert!((joints[0].y_m + d_m * alpha_rad.sin()).abs() < PREPARED);
        assert_eq!(joints[1].y_m, 0.0);
    }
}

#[test]
fn twists_of_quarter_turns_agree() {
    for convention in [Convention::Standard, Convention::Modified] {
        for quarters in 0..4_u32.pow(6) {
            let case = on_axes(convention, quarters);
            let gap = gap(&case);
            assert!(gap < PREPARED, "{gap:e}: {case:?}");
        }
    }
}

#[test]
fn nearly_parallel_axes_agree() {
    for exponent in 1..20 {
        let small = 10_f64.powi(-exponent);
        for (alpha_rad, beta_rad) in [(small, 0.0), (-small, small), (0.0, -small), (3.0, small)] {
            let link = Link {
                a_m: 0.3,
                alpha_rad,
                d_m: 0.2,
                theta_rad: 0.1,
                beta_rad,
                b_m: 0.1,
            };
            let case = Case {
                convention: Convention::Standard,
                links: vec![link; 4],
                motions: vec![Motion::Revolute; 4],
                joints: vec![0.3, -1.2, 2.0, 0.5],
                origins: Vec::new(),
            };
            let gap = gap(&case);
            assert!(gap < PREPARED, "{gap:e}: {case:?}");
        }
    }
}

#[test]
fn far_postures_are_served_too() {
    let mut case = on_axes(Convention::Standard, 0);
    for link in &mut case.links {
        // multiples of 1/8, so that the chain's own sums with the joint variables are exact
        (link.alpha_rad, link.theta_rad, link.beta_rad) = (0.375, -1.125, 0.0);
    }
    let mut gap_at = |joints: [f64; 3]| {
        case.joints = joints.to_vec();
        gap(&case)
    };
    // the offset is added to the variable: half the spacing of numbers of its size is lost
    let last_served: f64 = 999_999.875;
    let spacing = last_served.next_up() - last_served;
    assert!(gap_at([last_served, 0.2, -1.0]) < PREPARED + spacing);
    // beyond it the two are rotated into one
    for joints in [[1_000_000.125, 0.2, -1.0], [-1e9, 0.2, 1e15]] {
        let gap = gap_at(joints);
        assert!(gap < PREPARED, "{gap:e}: {joints:?}");
    }
    case.joints = vec![0.5, 1e140, 0.25];
    let (pose, jacobian) = prepared(&case).unwrap();
    let expected = case.jacobian();
    assert!(pose_gap(&pose, &case.pose()) < 1e140 * PREPARED);
    for (column, expected) in jacobian.iter().zip(&expected) {
        assert!(twist_gap(column, expected) < 1e140 * PREPARED);
    }
}

#[test]
fn what_cannot_be_answered_is_refused() {
    let motions = [Motion::Fixed, Motion::Revolute, Motion::Prismatic];
    let links = [Link {
        a_m: 0.1,
        alpha_rad: 0.2,
        ..Link::default()
    }; 3];
    let chain = Chain::new(Convention::Modified, &links, &motions).unwrap();
    let error = PreparedChain::<3>::new(&chain).unwrap_err();
    let (expected, got) = (2, 3);
    assert_eq!(error, KinematicsError::JointCount { expected, got });

    let prepared = PreparedChain::<2>::new(&chain).unwrap();
    let unchanged = [Twist {
        linear: [1.0, 2.0, 3.0].into(),
        angular: [4.0, 5.0, 6.0].into(),
    }; 2];
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for joint in 0..2 {
            let mut joints = [0.3, 1e7];
            joints[joint] = value;
            let mut out = unchanged;
            let error = prepared.pose_and_jacobian(&joints, &mut out).unwrap_err();
            let KinematicsError::NonFiniteJoint {
                joint: named, row, ..
            } = error
            else {
                panic!("{error}")
            };
            assert_eq!((named, row), (joint, joint + 1));
            assert_eq!(out, unchanged);
        }
    }
    let mut out = unchanged;
    let error = prepared
        .pose_and_jacobian(&[0.3, -2e150], &mut out)
        .unwrap_err();
    assert!(matches!(
        error,
        KinematicsError::PositionOutOfRange { row: 2, .. }
    ));

    let mut long = links;
    (long[0].a_m, long[1].d_m) = (6e149, -6e149);
    let chain = Chain::new(Convention::Modified, &long, &motions).unwrap();
    let error = PreparedChain::<2>::new(&chain).unwrap_err();
    assert!(matches!(
        error,
        KinematicsError::PositionOutOfRange { row: 1, .. }
    ));
}

#[test]
fn a_call_allocates_nothing() {
    let case = on_axes(Convention::Modified, 27);
    let mut jacobian = [Twist::default(); 3];
    let counted = allocation_counter::measure(|| {
        let prepared = PreparedChain::<3>::new(&case.chain()).unwrap();
        for first in [0.4, 1e6, f64::NAN] {
            let _ = prepared.pose_and_jacobian(&[first, 0.1, 0.2], &mut jacobian);
        }
    });
    assert_eq!(counted.count_total, 0, "{counted:?}");
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
    #![proptest_config(ProptestConfig::with_cases(8 * CASES))]

    #[test]
    fn random_chains_agree(case in case(convention())) {
        let gap = gap(&case);
        prop_assert!(gap < PREPARED, "{gap:e}");
        // and with the definition, on a way of its own
        let (pose, _) = prepared(&case).unwrap();
        let product = homogeneous_product(&case);
        for row in 0..3 {
            let position_gap = pose.position_m[row] - product[(row, 3)];
            prop_assert!(position_gap.abs() < PREPARED, "{position_gap:e}");
        }
    }

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
        let motions = [Motion::Revolute, Motion::Fixed, Motion::Prismatic];
        let chain = Chain::new(convention, &links, &motions).unwrap();
        if let Ok(prepared) = PreparedChain::<2>::new(&chain) {
            let mut out = [Twist::default(); 2];
            if let Ok(pose) = prepared.pose_and_jacobian(&joints, &mut out) {
                prop_assert!(pose.position_m.iter().chain(&pose.rotation).all(|x| x.is_finite()));
                for twist in out {
                    prop_assert!(twist.linear.iter().chain(&twist.angular).all(|x| x.is_finite()));
                }
            }
        }
    }
}

/// Every length counts by its size, whatever its sign: no two may make up for each other.
#[test]
fn lengths_that_together_leave_the_range_are_refused() {
    let half_m = 0.6e150;
    let rows = [
        (half_m, half_m, 0.0),
        (half_m, 0.0, -half_m),
        (0.0, -half_m, half_m),
    ];
    for (a_m, b_m, d_m) in rows {
        let links = [Link {
            a_m,
            b_m,
            d_m,
            ..Link::default()
        }];
        let chain = Chain::new(Convention::Standard, &links, &[Motion::Fixed]).unwrap();
        let refused = PreparedChain::<0>::new(&chain).unwrap_err();
        assert!(
            matches!(refused, KinematicsError::PositionOutOfRange { row: 0, .. }),
            "{refused}"
        );
    }
}
