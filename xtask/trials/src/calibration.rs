//! Calibration of stated probabilities.

use xtask_blind::Rate;

use super::batch::Case;

/// Bins of the reliability table.
const BINS: usize = 10;

/// Expected calibration error: over bins of a tenth, |mean probability - share right|, weighted by the
/// answers in the bin. Source: Naeini, Cooper & Hauskrecht, "Obtaining well calibrated probabilities using
/// Bayesian binning", AAAI 2015.
pub(crate) fn calibration_error(pairs: &[&(f64, bool)]) -> Option<f64> {
    let mut sums = [0.0; BINS];
    for (probability, outcome) in pairs {
        let probability = probability.clamp(0.0, 1.0);
        let bin = ((probability * BINS as f64) as usize).min(BINS - 1);
        sums[bin] += probability - f64::from(u8::from(*outcome));
    }
    let total: f64 = sums.iter().map(|sum| sum.abs()).sum();
    (!pairs.is_empty()).then(|| total / pairs.len() as f64)
}

/// Probabilities of what was answered, and whether it was so.
pub(crate) fn probabilities(cases: &[Case], suites: Option<&[&str]>) -> Vec<(f64, bool)> {
    let wanted = cases
        .iter()
        .filter(|case| suites.is_none_or(|suites| suites.contains(&case.suite)));
    wanted
        .filter_map(|case| case.score.as_ref()?.probability)
        .collect()
}

/// A bin of the reliability table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bin {
    pub(crate) probability: f64,
    /// How often it was so.
    pub(crate) happened: Rate,
}

/// Bins of a tenth that hold an answer.
pub(crate) fn reliability_bins(pairs: &[(f64, bool)]) -> Vec<Bin> {
    let mut bins: Vec<(f64, Vec<bool>)> = vec![(0.0, Vec::new()); BINS];
    for (probability, outcome) in pairs {
        let bin = ((probability.clamp(0.0, 1.0) * BINS as f64) as usize).min(BINS - 1);
        bins[bin].0 += probability;
        bins[bin].1.push(*outcome);
    }
    let filled = bins
        .into_iter()
        .filter(|(_, outcomes)| !outcomes.is_empty());
    filled
        .map(|(sum, outcomes)| Bin {
            probability: sum / outcomes.len() as f64,
            happened: Rate::of_cases(outcomes),
        })
        .collect()
}
