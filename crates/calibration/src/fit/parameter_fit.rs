//! The outcome of one fit: values, intervals, what the data fix.

use std::collections::BTreeMap;

use haptical_identification::{
    Convergence, Estimate, Identifiability, Matrix, NoiseScale, Uncertainty,
};
use haptical_model::{Device, ParameterId};
use serde::Serialize;

use crate::fit::considered::{Considered, Held};
use crate::{Channel, ChannelNoise};

/// The outcome of one fit.
#[derive(Debug, Clone)]
pub struct ParameterFit {
    /// The device with the fitted values.
    pub device: Device,
    /// All candidates.
    pub parameters: Vec<ParameterId>,
    /// Positions (within the candidates) that were fitted; the others keep their nominal values.
    pub fitted: Vec<usize>,
    /// Value, interval and status of every candidate.
    pub estimates: Vec<Estimate>,
    /// Covariance of the fitted candidates by the noise.
    pub uncertainty: Uncertainty,
    /// Parameters that were held although they are uncertain; the intervals contain them.
    pub considered: Considered,
    /// Where the size of the noise came from.
    pub noise: NoiseScale,
    /// Whether it was looked at for memory, drifts and uneven size: not in logs of more than 6 million residuals times
    /// parameters, nor in such of fewer than 24 rows.
    pub noise_is_checked: bool,
    /// The channels' noise, where it is not independent and of one size ([`crate::with_ordered_noise`] looks).
    pub channel_noise: Vec<ChannelNoise>,
    /// Whether the intervals of a robust fit allow every reading noise of a size of its own.
    pub is_widened: bool,
    /// Intervals that are not linearised ones ([`crate::calibrate`] looks for them).
    pub profiled: Profiled,
    /// What searches from other places said, where the first was doubted.
    pub starts: Starts,
    /// Judgement at the nominal device.
    pub nominal_identifiability: Identifiability,
    /// Judgement at the solution.
    pub identifiability: Identifiability,
    /// Why the search stopped.
    pub convergence: Convergence,
    /// Whether the search was one that others are only compared with ([`haptical_identification::Settings::to_compare`]) and ended as such.
    pub is_coarse: bool,
    /// Accepted steps, all rounds.
    pub iterations: usize,
    /// Sum of squared weighted residuals.
    pub cost: f64,
    /// Weighted residuals.
    pub residuals: Vec<f64>,
    /// Parameters that each channel's readings pay for: its part of the trace of
    /// J (J^T J)^-1 J^T; they add up to the number of fitted parameters.
    pub channel_parameters: BTreeMap<Channel, f64>,
}

impl ParameterFit {
    /// The parameters that are uncertain, the fitted ones and then those considered, and the covariance of their
    /// errors. Dependent ones are left out: what moves along the direction that the data leave open is not known by
    /// a covariance.
    pub fn uncertain(&self) -> (Vec<ParameterId>, Matrix) {
        self.uncertain_where(|held| held != Held::Dependent)
    }

    /// The same with the dependent ones, each off by as much as is plausible: what a number by itself is known to.
    pub fn uncertain_with_dependent(&self) -> (Vec<ParameterId>, Matrix) {
        self.uncertain_where(|_| true)
    }

    fn uncertain_where(&self, is_kept: impl Fn(Held) -> bool) -> (Vec<ParameterId>, Matrix) {
        let kept: Vec<usize> = (0..self.considered.parameters.len())
            .filter(|&k| is_kept(self.considered.held[k]))
            .collect();
        let considered = self.considered.select(&kept);
        let fitted = self.fitted.iter().map(|&index| self.parameters[index]);
        let covariance = considered.whole(&self.uncertainty.covariance);
        (fitted.chain(considered.parameters).collect(), covariance)
    }

    /// The candidates without those that the samples do not support, and the positions of the fitted ones among them.
    pub fn supported(&self) -> (Vec<ParameterId>, Vec<usize>) {
        let is_supported = |index: &usize| {
            let held = self.considered.reason(self.parameters[*index]);
            held != Some(Held::Unsupported)
        };
        let kept: Vec<usize> = (0..self.parameters.len()).filter(is_supported).collect();
        let fitted = self.fitted.iter();
        let places = fitted.filter_map(|index| kept.iter().position(|own| own == index));
        let places = places.collect();
        (
            kept.iter().map(|&index| self.parameters[index]).collect(),
            places,
        )
    }

    /// Names of two fitted parameters whose errors correlate by more than [`HIGH_CORRELATION`] in size, with the
    /// correlation, the strongest first.
    pub fn high_correlations(&self) -> Vec<(String, String, f64)> {
        let spread = &self.uncertainty;
        let name = |position: usize| self.estimates[spread.columns[position]].name.clone();
        let mut found = Vec::new();
        for a in 0..spread.columns.len() {
            for b in a + 1..spread.columns.len() {
                let correlation = spread.correlation(a, b);
                if correlation.abs() > HIGH_CORRELATION {
                    found.push((name(a), name(b), correlation));
                }
            }
        }
        found.sort_by(|one, other| other.2.abs().total_cmp(&one.2.abs()));
        found
    }
}

/// Correlations above this size are listed.
pub const HIGH_CORRELATION: f64 = 0.95;

/// The outcome of searches from other places, where a fit was doubted.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Starts {
    /// Why the first search, from the device's own values, was doubted; none where it was not, and then no other
    /// place was tried.
    pub doubt: Option<String>,
    /// Why the fit that was kept is doubted still: it may be another minimum than the device's, or the model lacks
    /// an effect.
    pub doubt_that_remains: Option<String>,
    /// Random places tried.
    pub tried: usize,
    /// How many of them led to the lowest minimum that any reached.
    pub reached_best: usize,
    /// Whether the first search had ended at another minimum, or at none, and a random place led to this one.
    pub replaced: bool,
    /// How many places led to plausible values that are others and fit as well: the recording does not tell which
    /// are the device's.
    pub rivals: usize,
    /// Seed of the random places.
    pub seed: u64,
}

/// What the sum of squares at the ends of the intervals said of them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Profiled {
    /// Whether the linearised ends were compared with the sum of squares. They are not where that would take more
    /// than 400 000 residuals times parameters: so many readings leave intervals over which everything is straight.
    pub is_checked: bool,
    /// Positions, within the candidates, of the parameters whose interval is its profile likelihood's.
    pub parameters: Vec<usize>,
    /// Those of them that the data do not bound on one side or both: they have no interval.
    pub open: Vec<usize>,
}
