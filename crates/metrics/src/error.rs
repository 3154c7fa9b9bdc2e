//! The one error type of this crate and the argument checks that return it.

/// Why a metric has no value for the given arguments.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MetricsError {
    /// A slice holds fewer values than the metric needs.
    #[error("{what} holds {got} values, at least {needed} are needed")]
    TooFew {
        /// Name of the argument.
        what: &'static str,
        /// Number of values received.
        got: usize,
        /// Smallest number that gives an answer.
        needed: usize,
    },
    /// A value is NaN or infinite.
    #[error("{what} is not finite at index {index}: {value}")]
    NonFinite {
        /// Name of the argument.
        what: &'static str,
        /// Position in the argument, row by row for a matrix, 0 for a single number.
        index: usize,
        /// The value found there.
        value: f64,
    },
    /// Two slices that are read in pairs have different lengths.
    #[error("{left} holds {left_len} values, {right} holds {right_len}")]
    LengthMismatch {
        /// Name of the first argument.
        left: &'static str,
        /// Its length.
        left_len: usize,
        /// Name of the second argument.
        right: &'static str,
        /// Its length.
        right_len: usize,
    },
    /// A number lies outside what the metric is defined for.
    #[error("{what} is {got}, allowed is {allowed}")]
    OutOfRange {
        /// Name of the argument.
        what: &'static str,
        /// The number received.
        got: f64,
        /// The allowed numbers, in words.
        allowed: &'static str,
    },
    /// Eq. (8) divides by the distance of the actual from the nominal value, which is zero.
    #[error("actual and nominal value are both {value}: the improvement is not defined")]
    ActualEqualsNominal {
        /// The common value.
        value: f64,
    },
    /// A 3 by 3 matrix is not a rotation.
    #[error("{what} is not a rotation: deviation {deviation}, allowed {tolerance}")]
    NotARotation {
        /// Name of the argument.
        what: &'static str,
        /// Largest entry of |A^T A - I|, or 2 for a reflection.
        deviation: f64,
        /// Largest deviation accepted.
        tolerance: f64,
    },
    /// The point pairs leave the rotation open (points on one line through the origin, or the like).
    #[error(
        "the point pairs do not determine a rotation: separation {separation} of the singular values, at least {needed} is needed"
    )]
    RotationNotUnique {
        /// Separation of the two smallest singular values (signed) over the largest.
        separation: f64,
        /// Smallest separation accepted.
        needed: f64,
    },
    /// A correlation is asked of a series whose values are all equal.
    #[error("all values of {what} are equal to {value}: a correlation is not defined")]
    ConstantSeries {
        /// Name of the argument.
        what: &'static str,
        /// The common value.
        value: f64,
    },
    /// The statistic of a bootstrap is undefined in too many resamples.
    #[error("the statistic is defined in {defined} of {replicates} resamples, needed is {needed}")]
    StatisticUndefined {
        /// Resamples in which the statistic has a value.
        defined: usize,
        /// Resamples drawn.
        replicates: usize,
        /// Smallest number of defined resamples accepted.
        needed: usize,
    },
    /// The arguments are finite and the result is too large for a 64-bit float.
    #[error("{what} is too large for a 64-bit float")]
    Overflow {
        /// Name of the result.
        what: &'static str,
    },
    /// An iteration inside the linear algebra did not converge.
    #[error("{what} did not converge within {iterations} iterations")]
    NoConvergence {
        /// Name of the iteration.
        what: &'static str,
        /// Number of iterations spent.
        iterations: usize,
    },
}

/// Refuses a NaN or infinite number.
pub(crate) fn check_finite(what: &'static str, value: f64) -> Result<(), MetricsError> {
    check_all_finite(what, &[value])
}

/// Refuses a slice with a NaN or infinite number.
pub(crate) fn check_all_finite(what: &'static str, values: &[f64]) -> Result<(), MetricsError> {
    match values.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(MetricsError::NonFinite {
            what,
            index,
            value: values[index],
        }),
        None => Ok(()),
    }
}

/// Refuses fewer than `needed` of something.
pub(crate) fn check_count(
    what: &'static str,
    got: usize,
    needed: usize,
) -> Result<(), MetricsError> {
    if got < needed {
        return Err(MetricsError::TooFew { what, got, needed });
    }
    Ok(())
}

/// Refuses a slice with fewer than `needed` numbers or with one that is not finite.
pub(crate) fn check_values(
    what: &'static str,
    values: &[f64],
    needed: usize,
) -> Result<(), MetricsError> {
    check_count(what, values.len(), needed)?;
    check_all_finite(what, values)
}

/// Refuses two arguments of different lengths.
pub(crate) fn check_same_length(
    (left, left_len): (&'static str, usize),
    (right, right_len): (&'static str, usize),
) -> Result<(), MetricsError> {
    if left_len == right_len {
        return Ok(());
    }
    Err(MetricsError::LengthMismatch {
        left,
        left_len,
        right,
        right_len,
    })
}

/// Refuses a number that is not within its range.
pub(crate) fn check_range(
    what: &'static str,
    got: f64,
    is_within: bool,
    allowed: &'static str,
) -> Result<(), MetricsError> {
    if is_within {
        return Ok(());
    }
    Err(MetricsError::OutOfRange { what, got, allowed })
}

/// Refuses a confidence level outside the open interval from 0 to 1.
pub(crate) fn check_level(level: f64) -> Result<(), MetricsError> {
    let is_within = level > 0.0 && level < 1.0;
    check_range("level", level, is_within, "between 0 and 1, both excluded")
}

/// Largest size of a number.
pub(crate) fn largest_size(values: &[f64]) -> f64 {
    let sizes = values.iter().map(|value| value.abs());
    sizes.fold(0.0, f64::max)
}

/// Returns the result when it is finite, otherwise says which result overflowed.
pub(crate) fn finite_result(what: &'static str, value: f64) -> Result<f64, MetricsError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(MetricsError::Overflow { what })
    }
}
