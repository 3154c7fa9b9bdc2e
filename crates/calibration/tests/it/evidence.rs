//! How much of a transmission's error few samples carry.

use haptical_calibration::{
    Channel, Degree, Held, Options, TransmissionTerms, Weights, fit_transmission,
};
use haptical_model::{Device, TransmissionKind};
use haptical_simulator::{Settings, apply_deviations, simulate_transmission};

use crate::haptic;

/// Recordings of each kind.
const SEEDS: u64 = 20;
/// A form with one superfluous term comes within 2 of the true one's criterion but is not taken for
/// that; by chance it is better by 2 in about one of ten recordings. Four of five must be right.
const RIGHT: usize = 16;

fn chosen(
    device: &Device,
    truth: &Device,
    joint: usize,
    rows: usize,
    seed: u64,
) -> TransmissionTerms {
    let recording = simulate_transmission(truth, &Settings::paper(), joint, rows, seed).unwrap();
    let channels = [Channel::Output { joint }];
    let weights = Weights::stated(device, &channels);
    let fit = fit_transmission(device, joint, &recording, &weights, &Options::default()).unwrap();
    if rows < 48 {
        assert!(fit.evidence.iter().any(|entry| entry.terms == fit.terms));
        assert!(
            fit.evidence
                .iter()
                .any(|entry| entry.terms == TransmissionTerms::None)
        );
        // a residual about the mean of the others is n / (n - 1) times as large
        let mut entries = fit.evidence.iter();
        let mean = entries.find(|entry| entry.terms == TransmissionTerms::Offset);
        let grown = mean.map(|mean| mean.leave_one_out_rms / mean.rms).unwrap();
        let wanted = rows as f64 / (rows - 1) as f64;
        assert!((grown - wanted).abs() < 1e-9, "{grown}, {wanted}");
    }
    let found = fit.fit.unwrap();
    assert_eq!(
        found.fitted.is_empty(),
        fit.terms == TransmissionTerms::None
    );
    let held = found.considered.held.iter();
    assert_eq!(
        held.filter(|held| **held == Held::Unsupported).count() + found.fitted.len(),
        found.parameters.len()
    );
    fit.terms
}

#[test]
fn few_samples_carry_the_planted_terms() {
    let Some(mut nominal) = haptic::haptic7() else {
        return;
    };
    // A direct joint with an external encoder: its eccentricity is an angle (1 m denominators).
    nominal.joints[4].external_encoder_sd_rad = Some(1e-4);
    let planted: [(&[(&str, f64)], TransmissionTerms); 3] = [
        (&[], TransmissionTerms::None),
        (&[("offset", 5e-3)], TransmissionTerms::Offset),
        (
            &[
                ("offset", 2e-3),
                ("output_drum_x", 3e-3),
                ("output_drum_y", -4e-3),
            ],
            TransmissionTerms::OffsetEccentricity,
        ),
    ];
    for (joint, scale) in [(4, 1.0), (0, 0.1)] {
        for (terms, expected) in &planted {
            let named: Vec<(String, f64)> = terms
                .iter()
                .map(|(name, size)| {
                    let length = if name.contains("drum") { scale } else { 1.0 };
                    (format!("{name}{}", joint + 1), size * length)
                })
                .collect();
            let deviations: Vec<(&str, f64)> =
                named.iter().map(|(n, x)| (n.as_str(), *x)).collect();
            let truth = apply_deviations(&nominal, &deviations).unwrap();
            let found: Vec<TransmissionTerms> = (0..SEEDS)
                .map(|seed| chosen(&nominal, &truth, joint, 40, 40 + seed))
                .collect();
            let right = found.iter().filter(|terms| *terms == expected).count();
            assert!(
                right >= RIGHT,
                "joint {}, {expected:?}: {found:?}",
                joint + 1
            );
        }
    }
}

#[test]
fn many_samples_of_a_capstan_get_equation_one() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    assert_eq!(
        chosen(&nominal, &nominal, 0, 120, 1),
        TransmissionTerms::Capstan
    );
    let recording = simulate_transmission(&nominal, &Settings::paper(), 0, 120, 1).unwrap();
    let weights = Weights::stated(&nominal, &[Channel::Output { joint: 0 }]);
    let zeroed = Options {
        zeroed_at_home: true,
        ..Options::default()
    };
    let fit = fit_transmission(&nominal, 0, &recording, &weights, &zeroed).unwrap();
    assert_eq!(fit.terms, TransmissionTerms::ZeroedCapstan);
    let offset = nominal.parameter("offset1").unwrap();
    let fit = fit.fit.unwrap();
    assert_eq!(offset.value(&fit.device), 0.0);
    assert!(!fit.parameters.contains(&offset));
}

/// The truth is a cubic: the evidence finds the degree, and a fixed degree is kept.
#[test]
fn a_polynomial_gets_the_degree_that_it_has() {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    assert_eq!(
        nominal.joints[3].transmission,
        TransmissionKind::Parallelogram
    );
    let truth = haptic::truth_of(&nominal, 1.0);
    let right = (0..SEEDS)
        .filter(|seed| {
            chosen(&nominal, &truth, 3, 300, 70 + seed) == TransmissionTerms::Polynomial(3)
        })
        .count();
    assert!(right >= RIGHT, "{right} of {SEEDS}");
    let recording = simulate_transmission(&truth, &Settings::paper(), 3, 300, 1).unwrap();
    let weights = Weights::stated(&nominal, &[Channel::Output { joint: 3 }]);
    let options = Options {
        degree: Degree::Fixed(7),
        ..Options::default()
    };
    let fit = fit_transmission(&nominal, 3, &recording, &weights, &options).unwrap();
    assert_eq!(fit.terms, TransmissionTerms::Polynomial(7));
    assert!(fit.evidence.is_empty());
}
