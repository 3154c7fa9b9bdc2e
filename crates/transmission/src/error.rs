//! The reasons for which a transmission error or its inverse has no answer.

/// Why a transmission function has no answer; each variant names what was wrong, the value it got and
/// what would have been allowed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LawError {
    /// An argument, or a result computed from it, is infinite or not a number.
    #[error("{quantity} is {value}; a finite number is needed")]
    NonFinite {
        /// Name of the argument or result, with its unit.
        quantity: &'static str,
        /// Its value.
        value: f64,
    },
    /// An argument is finite but outside its domain.
    #[error("{quantity} is {value}; allowed: {allowed}")]
    OutOfRange {
        /// Name of the argument, with its unit.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// The domain.
        allowed: &'static str,
    },
    /// The ratio deviation cancels the nominal ratio, so that the output does not move.
    #[error(
        "ratio deviation {ratio_deviation} cancels the transmission ratio {transmission_ratio}"
    )]
    SingularRatio {
        /// Nominal ratio `R`.
        transmission_ratio: f64,
        /// Deviation `R_e`.
        ratio_deviation: f64,
    },
    /// A drum's centre lies at or beyond the other end of the line of centres.
    #[error(
        "{drum} drum eccentricity {eccentricity_m} m must be less than its denominator {denominator_m} m"
    )]
    EccentricityTooLarge {
        /// `"output"` or `"input"`.
        drum: &'static str,
        /// Distance of the drum's centre from its axis.
        eccentricity_m: f64,
        /// Length it is compared with.
        denominator_m: f64,
    },
    /// Four bars of these lengths cannot be joined at this angle.
    #[error("bars of {lengths_m:?} m do not close at {theta_a_rad} rad")]
    OpenLoop {
        /// Lengths AB, BC, CE, EA, deviations included.
        lengths_m: [f64; 4],
        /// Input angle from home.
        theta_a_rad: f64,
    },
    /// The loop has a triangle that is a line, or the angle lies beyond such a posture.
    #[error("bars of {lengths_m:?} m are singular at {theta_a_rad} rad")]
    SingularLoop {
        /// Lengths AB, BC, CE, EA, deviations included.
        lengths_m: [f64; 4],
        /// Input angle from home.
        theta_a_rad: f64,
    },
    /// A range or bracket is not two finite angles in ascending order.
    #[error(
        "{quantity} [{lower_rad}, {upper_rad}] rad is not two finite angles in ascending order"
    )]
    InvalidRange {
        /// `"range"` or `"bracket"`.
        quantity: &'static str,
        /// First end.
        lower_rad: f64,
        /// Second end.
        upper_rad: f64,
    },
    /// Two slices that belong together differ in length.
    #[error("{quantity} has {got} entries; {expected} are needed")]
    LengthMismatch {
        /// Name of the slice.
        quantity: &'static str,
        /// Its length.
        got: usize,
        /// The length needed.
        expected: usize,
    },
    /// The wanted output angle is not reached inside the bracket.
    #[error(
        "output {output_rad} rad is not reached: the bracket {bracket_rad:?} rad gives {reached_rad:?} rad"
    )]
    NotBracketed {
        /// Wanted output angle.
        output_rad: f64,
        /// Encoder angles searched.
        bracket_rad: [f64; 2],
        /// Output angles at the ends of the bracket.
        reached_rad: [f64; 2],
    },
    /// The output angle does not grow with the encoder angle, so the inverse is not unique.
    #[error("the output angle does not grow at {theta_rad} rad: its slope is {slope}")]
    NotMonotone {
        /// Encoder angle at which this was seen.
        theta_rad: f64,
        /// Slope there: the derivative, or a difference quotient of neighbours.
        slope: f64,
    },
    /// The inverse did not settle.
    #[error("no inverse for {output_rad} rad after {iterations} steps; last angle {theta_rad} rad")]
    NoConvergence {
        /// Wanted output angle.
        output_rad: f64,
        /// Last iterate.
        theta_rad: f64,
        /// Steps taken.
        iterations: usize,
    },
}

/// Passes a finite `value` on.
pub(crate) fn finite(quantity: &'static str, value: f64) -> Result<f64, LawError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(LawError::NonFinite { quantity, value })
    }
}

/// Passes a finite `value` above zero on.
pub(crate) fn positive(quantity: &'static str, value: f64) -> Result<f64, LawError> {
    if finite(quantity, value)? > 0.0 {
        Ok(value)
    } else {
        Err(LawError::OutOfRange {
            quantity,
            value,
            allowed: "greater than 0",
        })
    }
}

/// Passes a pair of finite angles in ascending order on, with a finite width.
pub(crate) fn ascending(
    quantity: &'static str,
    [lower_rad, upper_rad]: [f64; 2],
) -> Result<[f64; 2], LawError> {
    if lower_rad < upper_rad && (upper_rad - lower_rad).is_finite() {
        Ok([lower_rad, upper_rad])
    } else {
        Err(LawError::InvalidRange {
            quantity,
            lower_rad,
            upper_rad,
        })
    }
}
