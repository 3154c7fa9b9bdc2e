//! Checks what must hold for every chain: symmetries, orthonormality, the two conventions' relation.

use haptical_kinematics::nalgebra::{Matrix3, Vector3};
use haptical_kinematics::{Convention, Link, Motion, Parameter, Pose};
use haptical_kinematics::{distance_derivative, distance_m};
use proptest::prelude::*;

use crate::support::{
    CASES, Case, ROUNDING, case, convention, gap, pose_gap, rotation_z, table, twist_gap,
};

/// A standard chain re-expressed as a modified one with one row more.
///
/// `Rz(theta) Tz(d)` of a row and `T(a, b, 0) Rx(alpha) Ry(beta)` of the row before it make one modified
/// row, because slides along x and z commute; the last row's second half is alone at the end.
fn as_modified(standard: &Case) -> Case {
    let mut links = vec![Link::default(); standard.links.len() + 1];
    for (row, link) in standard.links.iter().enumerate() {
        links[row].theta_rad = link.theta_rad;
        links[row].d_m = link.d_m;
        links[row + 1].a_m = link.a_m;
        links[row + 1].alpha_rad = link.alpha_rad;
        links[row + 1].beta_rad = link.beta_rad;
        links[row + 1].b_m = link.b_m;
    }
    let mut motions = standard.motions.clone();
    motions.push(Motion::Fixed);
    Case {
        convention: Convention::Modified,
        links,
        motions,
        joints: standard.joints.clone(),
        origins: Vec::new(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]

    #[test]
    fn rotation_is_orthonormal_and_right_handed(case in case(convention())) {
        let rotation = case.pose().rotation;
        let product = rotation * rotation.transpose();
        prop_assert!(gap(&product, &Matrix3::identity()) < ROUNDING);
        prop_assert!((rotation.determinant() - 1.0).abs() < ROUNDING);
    }

    /// A turn of the first standard row by `turn` turns the whole arm about z of frame (-1), so no
    /// distance from a point of that axis changes.
    #[test]
    fn first_theta_turns_everything(
        case in table(Just(Convention::Standard)),
        turn in -3.0..3.0_f64,
        height_m in -1.0..1.0_f64,
    ) {
        let (before, after) = (case.pose(), case.moved(0, Parameter::Theta, turn).pose());
        let expected = Pose {
            position_m: rotation_z(turn) * before.position_m,
            rotation: rotation_z(turn) * before.rotation,
        };
        prop_assert!(pose_gap(&after, &expected) < ROUNDING);

        let anchor_m = Vector3::new(0.0, 0.0, height_m);
        let theta = case.derivatives()[0].theta;
        prop_assume!((before.position_m - anchor_m).norm() > 1e-3);
        let distances = [&before, &after].map(|pose| distance_m(&pose.position_m, &anchor_m).unwrap());
        prop_assert!((distances[0] - distances[1]).abs() < ROUNDING);
        prop_assert!(distance_derivative(&before, &anchor_m, &theta).unwrap().abs() < ROUNDING);
    }

    /// The last standard row's alpha and beta turn the handle about its own origin.
    #[test]
    fn last_twists_leave_the_position(case in table(Just(Convention::Standard))) {
        let derivatives = case.derivatives();
        let last = derivatives.last().unwrap();
        prop_assert_eq!(last.alpha.linear, Vector3::zeros());
        prop_assert_eq!(last.beta.linear, Vector3::zeros());
        prop_assert!((last.alpha.angular.norm() - 1.0).abs() < ROUNDING);
    }

    #[test]
    fn standard_chain_equals_its_modified_form(standard in table(Just(Convention::Standard))) {
        let modified = as_modified(&standard);
        prop_assert!(pose_gap(&standard.pose(), &modified.pose()) < ROUNDING);
        let (left, right) = (standard.derivatives(), modified.derivatives());
        for row in 0..left.len() {
            for (parameter, shift) in [
                (Parameter::Theta, 0),
                (Parameter::D, 0),
                (Parameter::A, 1),
                (Parameter::Alpha, 1),
                (Parameter::Beta, 1),
                (Parameter::B, 1),
            ] {
                let (l, r) = (left[row].get(parameter), right[row + shift].get(parameter));
                prop_assert!(twist_gap(&l, &r) < ROUNDING, "row {row} {parameter}");
            }
        }
    }

    /// Cutting a chain in two and joining the halves' poses gives the whole chain's pose.
    #[test]
    fn chains_compose(case in case(convention()), cut in 1..10_usize) {
        prop_assume!(cut < case.links.len());
        let moving = case.motions[..cut].iter().filter(|motion| **motion != Motion::Fixed).count();
        // the origin at the cut belongs to one half
        let half = |rows: core::ops::Range<usize>, origins: core::ops::Range<usize>, joints: &[f64]| Case {
            convention: case.convention,
            links: case.links[rows.clone()].to_vec(),
            motions: case.motions[rows].to_vec(),
            joints: joints.to_vec(),
            origins: case.origins.get(origins).unwrap_or_default().to_vec(),
        };
        let first = half(0..cut, 0..cut, &case.joints[..moving]).pose();
        let second = half(cut..case.links.len(), cut..case.links.len() + 1, &case.joints[moving..]).pose();
        let joined = Pose {
            position_m: first.position_m + first.rotation * second.position_m,
            rotation: first.rotation * second.rotation,
        };
        prop_assert!(pose_gap(&case.pose(), &joined) < ROUNDING);
    }

    /// Lengths scale positions and their derivatives by angles, and nothing else.
    #[test]
    fn lengths_scale_positions(case in case(convention()), scale in 0.1..10.0_f64) {
        let mut scaled = case.clone();
        for link in &mut scaled.links {
            link.a_m *= scale;
            link.d_m *= scale;
            link.b_m *= scale;
        }
        for origin in scaled.origins.iter_mut().flatten() {
            origin.position_m *= scale;
        }
        for (joint, motion) in scaled.joints.iter_mut().zip(
            case.motions.iter().filter(|motion| **motion != Motion::Fixed),
        ) {
            if *motion == Motion::Prismatic {
                *joint *= scale;
            }
        }
        let (small, large) = (case.pose(), scaled.pose());
        prop_assert!(gap(&(small.position_m * scale), &large.position_m) < 10.0 * ROUNDING);
        prop_assert!(gap(&small.rotation, &large.rotation) < ROUNDING);
    }
}
