//! Scores a fit of a certified problem in digits: the log relative error.

use haptical_identification::{Fit, IdentificationError, NoiseScale, Settings, solve, uncertainty};

use super::Certified;

/// Certified values carry 11 digits: more cannot be shown.
pub(crate) const CERTIFIED_DIGITS: f64 = 11.0;

/// Least digits of each kind.
pub(crate) struct Score {
    pub(crate) name: &'static str,
    pub(crate) fit: Fit,
    pub(crate) parameters: f64,
    pub(crate) standard_deviations: f64,
    pub(crate) cost: f64,
}

impl Score {
    /// Fits from start 0 (far) or 1 (near) and compares.
    ///
    /// # Errors
    /// As [`solve`].
    pub(crate) fn new(
        problem: &Certified,
        start: usize,
        settings: &Settings,
    ) -> Result<Self, IdentificationError> {
        let free: Vec<usize> = (0..problem.parameters.len()).collect();
        let fit = solve(problem, &problem.starts[start], &free, settings)?;
        let deviations: Vec<f64> =
            match uncertainty(&fit.reduction, &free, fit.cost, NoiseScale::Estimated) {
                Ok(answer) => free.iter().map(|&p| answer.standard_deviation(p)).collect(),
                Err(_) => vec![f64::NAN; free.len()],
            };
        Ok(Self {
            name: problem.name,
            parameters: worst(&fit.parameters, &problem.parameters),
            standard_deviations: worst(&deviations, &problem.standard_deviations),
            cost: digits(fit.cost, problem.residual_sum_of_squares),
            fit,
        })
    }

    /// Whether parameters and residual sum of squares have that many digits. Lanczos1's sum, 1.4e-25,
    /// is of residuals of 1e-13 that are differences of numbers near 2: its parameters count alone.
    pub(crate) fn has_digits(&self, digits: f64) -> bool {
        self.parameters >= digits && (self.cost >= digits || self.name == "Lanczos1")
    }

    /// Whether the solver says that it found a minimum, and it is not the certified one.
    pub(crate) fn is_false_claim(&self) -> bool {
        /// Enough to tell one minimum from another.
        const SAME_MINIMUM_DIGITS: f64 = 4.0;
        self.fit.convergence.was_successful() && self.parameters < SAME_MINIMUM_DIGITS
    }
}

/// Log relative error: -log10 |x - c| / |c|, between 0 and 11.
pub(crate) fn digits(value: f64, certified: f64) -> f64 {
    let relative = ((value - certified) / certified).abs();
    if relative.is_nan() {
        return 0.0;
    }
    let least = 10.0_f64.powf(-CERTIFIED_DIGITS);
    // no minus zero
    -relative.clamp(least, 1.0).log10() + 0.0
}

/// Least digits of all.
pub(crate) fn worst(values: &[f64], certified: &[f64]) -> f64 {
    let pairs = values.iter().zip(certified);
    pairs
        .map(|(value, certified)| digits(*value, *certified))
        .fold(CERTIFIED_DIGITS, f64::min)
}
