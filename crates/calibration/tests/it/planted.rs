//! Dependences that are planted must be found, named, and have the planted coefficient.

use haptical_calibration::{Channel, Weights, candidate_parameters, identifiability_at};
use haptical_identification::{IdentifiabilityRules, Status};
use haptical_model::{Parameter, ParameterId};
use proptest::prelude::*;

use crate::chain::{
    ROWS, Rig, combination, generic_chain, judge, measure, measure_at, turned_when_locked,
};

/// See the same constant of the counts.
const COEFFICIENT_TOLERANCE: f64 = 1e-6;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Successive parallel axes: slides along one direction; Hayati's angle restores the rank.
    #[test]
    fn parallel_axes_share_an_offset(device in generic_chain(3..=6), at in 0.0..1.0_f64, opposed: bool, seed: u64) {
        let mut device = device;
        let n = device.joints.len();
        let row = 1 + (at * (n - 1) as f64) as usize;
        device.links[row].alpha_rad = if opposed { std::f64::consts::PI } else { 0.0 };
        let recording = measure(&device, Rig::Cable, ROWS, seed);
        let judged = judge(&device, &recording);
        prop_assert_eq!(judged.rank, 4 * n, "with beta{}", row);
        let slide = format!("d{}", row + 1);
        // short links leave both slides as large as the noise: then they are weak, and nothing is said of their sum
        let own = judged.names.iter().position(|name| *name == slide);
        prop_assume!(own.is_some_and(|own| !matches!(judged.statuses[own], Status::Weak { .. })));
        let found = combination(&judged, &slide);
        prop_assert_eq!(found.len(), 1, "{:?}", &found);
        prop_assert_eq!(found[0].0, format!("d{row}"));
        let sign = if opposed { -1.0 } else { 1.0 };
        prop_assert!((found[0].1 - sign).abs() < COEFFICIENT_TOLERANCE);

        let plain: Vec<ParameterId> = candidate_parameters(&device)
            .into_iter()
            .filter(|p| !matches!(p, ParameterId::Link { parameter: Parameter::Beta, .. }))
            .collect();
        let channels = [Channel::Cable { index: 0 }];
        let weights = Weights::stated(&device, &channels);
        let rules = IdentifiabilityRules::default();
        let judged = identifiability_at(&device, &recording, &channels, &plain, &weights, &rules).unwrap();
        prop_assert_eq!(judged.rank, 4 * n - 1, "without beta{}", row);
    }

    /// A transmission's constant turns its joint like the joint's offset: factor 1.
    #[test]
    fn a_constant_error_acts_like_the_joint_offset(device in generic_chain(3..=5), at in 0.0..1.0_f64, seed: u64) {
        let joint = (at * device.joints.len() as f64) as usize;
        let mut parameters = candidate_parameters(&device);
        parameters.push(ParameterId::Transmission { joint, index: 0 });
        let channels = [Channel::Cable { index: 0 }];
        let weights = Weights::stated(&device, &channels);
        let rules = IdentifiabilityRules::default();
        let recording = measure(&device, Rig::Cable, ROWS, seed);
        let judged = identifiability_at(&device, &recording, &channels, &parameters, &weights, &rules).unwrap();
        prop_assert_eq!(judged.rank, 4 * device.joints.len());
        let found = combination(&judged, &format!("offset{}", joint + 1));
        prop_assert_eq!(found.len(), 1, "{:?}", &found);
        prop_assert_eq!(found[0].0, format!("theta{}", joint + 1));
        prop_assert!((found[0].1 - 1.0).abs() < COEFFICIENT_TOLERANCE);
    }

    /// Rows whose x axes are nearly parallel at the locked reading: some columns depend on nearly
    /// dependent ones, so that rounding alone exceeds the tolerance. A verdict must come all the same.
    #[test]
    fn a_joint_locked_nearly_straight_still_gets_a_verdict(device in generic_chain(3..=5), at in 0.0..1.0_f64, straight in -5e-4..5e-4_f64, seed: u64) {
        let joint = (at * device.joints.len() as f64) as usize;
        let reading = straight - device.links[joint + 1].theta_rad;
        let mut readings = measure(&device, Rig::Position, ROWS, seed).joint;
        readings[joint] = vec![reading; ROWS];
        let judged = judge(&device, &measure_at(&device, Rig::Position, readings));
        prop_assert!(judged.rank <= judged.names.len() - 4);
    }

    /// Of a locked last joint two rows merge: theta_n, d_n, a_n only move one point.
    #[test]
    fn a_locked_joint_is_a_combination_of_its_neighbours(device in generic_chain(3..=5), at in 0.0..1.0_f64, seed: u64) {
        let n = device.joints.len();
        let joint = (at * n as f64) as usize;
        prop_assume!(turned_when_locked(&device, joint, -0.2));
        let mut readings = measure(&device, Rig::Position, ROWS, seed).joint;
        readings[joint] = vec![-0.2; ROWS];
        let judged = judge(&device, &measure_at(&device, Rig::Position, readings));
        let row = joint + 1;
        let neighbours = [row - 1, row, (row + 1).min(n)];
        for name in crate::chain::pruned(&judged).1 {
            let near = |name: &str| neighbours.iter().any(|row| name.ends_with(&row.to_string()));
            prop_assert!(near(name), "{} pruned, joint {} locked", name, row);
            for (kept, _) in combination(&judged, name) {
                prop_assert!(near(kept), "{} acts like {}, joint {} locked", name, kept, row);
            }
        }
    }
}
