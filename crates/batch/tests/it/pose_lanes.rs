//! Poses and Jacobians in lanes against the chain's own, posture by posture.

use haptical_batch::{BatchError, PoseLanes};
use haptical_kinematics::{Chain, Convention, KinematicsError, Motion, Pose, Twist};
use proptest::prelude::*;

use crate::support::{Case, case, cases, random_case};

/// Both ways round some 45 elementary motions and sines, for chains of at most 7 m: a few times 7 m
/// 2.2e-16.
const LANES: f64 = 2e-14;

/// Numbers of the chain's own answer in the order of the blocks.
fn expected(case: &Case, posture: usize) -> Vec<f64> {
    let chain = Chain::new(case.convention, &case.links, &case.motions).unwrap();
    let mut jacobian = vec![Twist::default(); case.joints.len()];
    let pose = chain
        .geometric_jacobian(&case.variables(posture), &mut jacobian)
        .unwrap();
    numbers(&pose, &jacobian)
}

fn numbers(pose: &Pose, jacobian: &[Twist]) -> Vec<f64> {
    let mut numbers: Vec<f64> = pose.position_m.iter().copied().collect();
    // column by column
    numbers.extend(pose.rotation.iter());
    for column in jacobian {
        numbers.extend(column.linear.iter());
        numbers.extend(column.angular.iter());
    }
    numbers
}

/// Numbers of every posture, from the blocks; the accessors must say the same.
fn lanes(case: &Case) -> Result<Vec<Vec<f64>>, BatchError> {
    fn in_lanes<const JOINTS: usize>(case: &Case) -> Result<Vec<Vec<f64>>, BatchError> {
        let chain = Chain::new(case.convention, &case.links, &case.motions).unwrap();
        let mut lanes = PoseLanes::<JOINTS>::new(&chain)?;
        let joints: &[Vec<f64>; JOINTS] = case.joints.as_slice().try_into().unwrap();
        lanes.evaluate(joints)?;
        let count = PoseLanes::<JOINTS>::NUMBERS;
        let postures = case.joints.first().map_or(0, Vec::len);
        assert_eq!((lanes.len(), lanes.is_empty()), (postures, postures == 0));
        assert!(lanes.pose(postures).is_none() && lanes.jacobian(postures).is_none());
        assert_eq!(lanes.blocks().len(), postures.div_ceil(8) * 8 * count);
        let of_posture = |posture: usize| -> Vec<f64> {
            let entry = |number: usize| 8 * (count * (posture / 8) + number) + posture % 8;
            let found = (0..count).map(|number| lanes.blocks()[entry(number)]);
            let found: Vec<f64> = found.collect();
            let pose = lanes.pose(posture).unwrap();
            assert_eq!(found, numbers(&pose, &lanes.jacobian(posture).unwrap()));
            found
        };
        Ok((0..postures).map(of_posture).collect())
    }
    match case.joints.len() {
        0 => in_lanes::<0>(case),
        1 => in_lanes::<1>(case),
        2 => in_lanes::<2>(case),
        3 => in_lanes::<3>(case),
        4 => in_lanes::<4>(case),
        5 => in_lanes::<5>(case),
        6 => in_lanes::<6>(case),
        7 => in_lanes::<7>(case),
        8 => in_lanes::<8>(case),
        joints => panic!("{joints} joints"),
    }
}

fn largest_gap(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    found
        .iter()
        .zip(expected)
        .map(|(found, expected)| (found - expected).abs())
        // not f64::max alone, which would pass over a NaN
        .fold(0.0, |worst, gap| {
            if gap.is_nan() {
                f64::INFINITY
            } else {
                worst.max(gap)
            }
        })
}

/// A chain with a prismatic joint in its middle.
fn with_slide(postures: usize) -> Case {
    let mut motions = [Motion::Revolute; 5];
    (motions[0], motions[2]) = (Motion::Fixed, Motion::Prismatic);
    random_case(Convention::Standard, &motions, postures, 11)
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn random_chains_agree(case in case(1..70)) {
        let found = lanes(&case).unwrap();
        let postures = case.joints.first().map_or(0, Vec::len);
        prop_assert_eq!(found.len(), postures);
        for (posture, found) in found.iter().enumerate() {
            let gap = largest_gap(found, &expected(&case, posture));
            prop_assert!(gap < LANES, "posture {posture}: {gap:e}");
        }
    }
}

#[test]
fn a_posture_does_not_depend_on_those_beside_it() {
    let case = with_slide(100);
    let all = lanes(&case).unwrap();
    for (first, count) in [(0, 1), (3, 29), (37, 63), (99, 1)] {
        let mut part = case.clone();
        for joint in &mut part.joints {
            *joint = joint[first..first + count].to_vec();
        }
        assert_eq!(lanes(&part).unwrap(), all[first..first + count]);
    }
    // nor on a far one
    let mut far = case.clone();
    far.joints[0][40] = 1e7;
    let found = lanes(&far).unwrap();
    for (posture, (found, all)) in found.iter().zip(&all).enumerate() {
        if posture != 40 {
            assert_eq!(found, all, "posture {posture}");
        }
    }
}

#[test]
fn far_postures_are_served_too() {
    let mut case = with_slide(50);
    for link in &mut case.links {
        // so that the chain's own sums with the joint variables are exact
        link.theta_rad = 0.0;
    }
    case.joints[0][7] = 3e5;
    case.joints[3][8] = -1e12;
    case.joints[2][49] = 1e300;
    case.joints[1][31] = 1e6;
    let found = lanes(&case).unwrap();
    for (posture, found) in found.iter().enumerate() {
        // a slide of 1e6 m
        let size = if posture == 31 { 1e6 } else { 1.0 };
        // within the range of the lanes an angle and its row's offset are one sum
        let spacing = if posture == 7 {
            3e5 * f64::EPSILON
        } else {
            0.0
        };
        let gap = largest_gap(found, &expected(&case, posture));
        assert!(gap < LANES * size + spacing, "posture {posture}: {gap:e}");
    }
}

#[test]
fn what_cannot_be_answered_is_refused_by_posture() {
    let case = with_slide(50);
    for (joint, posture, value) in [
        (0, 0, f64::NAN),
        (1, 33, f64::INFINITY),
        (3, 49, f64::NEG_INFINITY),
    ] {
        let mut case = case.clone();
        case.joints[joint][posture] = value;
        let error = lanes(&case).unwrap_err();
        let BatchError::Pose { pose, .. } = error else {
            panic!("{error}")
        };
        assert_eq!(pose, posture);
    }
    let mut beyond = case.clone();
    beyond.joints[1][12] = -2e150;
    let message = lanes(&beyond).unwrap_err().to_string();
    assert!(
        message.contains("prismatic joint's variable of pose 12"),
        "{message}"
    );

    let mut short = case.clone();
    short.joints[2].pop();
    assert!(matches!(
        lanes(&short),
        Err(BatchError::Length {
            expected: 50,
            found: 49,
            ..
        })
    ));

    let chain = Chain::new(case.convention, &case.links, &case.motions).unwrap();
    let (expected, got) = (4, 7);
    assert_eq!(
        PoseLanes::<7>::new(&chain).unwrap_err(),
        BatchError::Chain(KinematicsError::JointCount { expected, got })
    );
}

#[test]
fn a_refusal_leaves_no_postures() {
    let case = with_slide(20);
    let chain = Chain::new(case.convention, &case.links, &case.motions).unwrap();
    let mut lanes = PoseLanes::<4>::new(&chain).unwrap();
    let mut joints: [Vec<f64>; 4] = case.joints.clone().try_into().unwrap();
    lanes.evaluate(&joints).unwrap();
    assert_eq!(lanes.len(), 20);
    joints[3][19] = f64::NAN;
    assert!(lanes.evaluate(&joints).is_err());
    assert!(lanes.is_empty() && lanes.pose(0).is_none() && lanes.blocks().is_empty());
    // no posture is an answer too
    lanes.evaluate(&[const { Vec::new() }; 4]).unwrap();
    assert!(lanes.is_empty());
}

#[test]
fn an_evaluation_allocates_nothing_once_its_room_is_there() {
    let case = with_slide(300);
    let chain = Chain::new(case.convention, &case.links, &case.motions).unwrap();
    let mut lanes = PoseLanes::<4>::new(&chain).unwrap();
    let joints: [Vec<f64>; 4] = case.joints.clone().try_into().unwrap();
    let few: [&[f64]; 4] = std::array::from_fn(|joint| &joints[joint][..77]);
    lanes.evaluate(&joints).unwrap();
    let counted = allocation_counter::measure(|| {
        lanes.evaluate(&joints).unwrap();
        lanes.evaluate(&few).unwrap();
    });
    assert_eq!(counted.count_total, 0, "{counted:?}");
}
