//! Thresholds that decide whether a parameter counts as fixed by the data.

use haptical_linalg::RANK_TOLERANCE;
use serde::Serialize;

use crate::IdentificationError;

/// Thresholds of the analysis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct IdentifiabilityRules {
    /// A column whose plausible effect is below this share of the largest is invisible.
    pub zero_tolerance: f64,
    /// Remainder of a unit-norm column below which it is a combination of others.
    pub rank_tolerance: f64,
    /// Standard deviation, as a share of the plausible size, above which a parameter is weak.
    pub weak_share: f64,
    /// Work out singular values, condition number and observability. Statuses, rank and standard
    /// deviations are the same without them, and take a fifth of the time: for many simulated devices.
    #[serde(skip)]
    pub singular_values: bool,
}

impl Default for IdentifiabilityRules {
    fn default() -> Self {
        // zero_tolerance: analytic derivatives of an absent effect are rounding, about 1e-16 of the
        // others; weak_share: data that shrink the plausible size by less than half say little.
        Self {
            zero_tolerance: 1e-11,
            rank_tolerance: RANK_TOLERANCE,
            weak_share: 0.5,
            singular_values: true,
        }
    }
}

impl IdentifiabilityRules {
    /// Refuses thresholds outside their range.
    ///
    /// # Errors
    /// [`IdentificationError::Setting`].
    pub fn check(&self) -> Result<(), IdentificationError> {
        IdentificationError::unless_share("zero_tolerance", self.zero_tolerance)?;
        IdentificationError::unless_share("rank_tolerance", self.rank_tolerance)?;
        positive("weak_share", self.weak_share)
    }
}

pub(crate) fn positive(name: &'static str, value: f64) -> Result<(), IdentificationError> {
    let is_allowed = value.is_finite() && value > 0.0;
    IdentificationError::unless(is_allowed, name, value, "finite and above 0")
}
