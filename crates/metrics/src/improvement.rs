//! Improvement of parameters, of an RMS error and of a gap above a noise floor.

use serde::{Deserialize, Serialize};

use crate::error::{
    MetricsError, check_finite, check_range, check_values, finite_result, largest_size,
};

/// Improvement of one identified parameter over its nominal value, in percent.
///
/// `100 (1 - |actual - estimated| / |actual - nominal|)`: 100 when the estimate is exact, 0 when it
/// is as far from the actual value as the nominal one, negative when it is farther. The three
/// arguments share one unit. Source: Baser & Konukseven eq. (8).
///
/// # Errors
/// [`MetricsError::ActualEqualsNominal`] when the denominator is zero, [`MetricsError::NonFinite`]
/// for a NaN or infinite argument, [`MetricsError::Overflow`] when the result is not representable.
///
/// # Examples
/// Link twist 4 of table 3, deviations from nominal in mrad (printed: 81.35, from unrounded values):
/// ```
/// let percent = haptical_metrics::parameter_improvement_percent(1.2, 1.424, 0.0)?;
/// assert!((percent - 81.333).abs() < 5e-4);
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn parameter_improvement_percent(
    actual: f64,
    estimated: f64,
    nominal: f64,
) -> Result<f64, MetricsError> {
    check_finite("actual", actual)?;
    check_finite("estimated", estimated)?;
    check_finite("nominal", nominal)?;
    if actual == nominal {
        return Err(MetricsError::ActualEqualsNominal { value: actual });
    }
    let remaining = (actual - estimated).abs() / (actual - nominal).abs();
    finite_result("the parameter improvement", 100.0 * (1.0 - remaining))
}

/// Root mean square of the values, in their unit: `sqrt(sum(v^2) / n)`.
///
/// The values are divided by the largest magnitude before squaring, so that no finite input
/// overflows.
///
/// # Errors
/// [`MetricsError::TooFew`] for an empty slice, [`MetricsError::NonFinite`] for a NaN or infinity.
///
/// # Examples
/// ```
/// assert_eq!(haptical_metrics::rms(&[3.0, -4.0, 0.0, 0.0])?, 2.5);
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn rms(values: &[f64]) -> Result<f64, MetricsError> {
    check_values("values", values, 1)?;
    let largest = largest_size(values);
    if largest == 0.0 {
        return Ok(0.0);
    }
    let mean_square = values
        .iter()
        .map(|value| (value / largest).powi(2))
        .sum::<f64>()
        / values.len() as f64;
    Ok(largest * mean_square.sqrt())
}

/// Improvement of an RMS error, with the direction that the printed formula loses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RmsImprovement {
    /// Eq. (9) as printed, with the magnitude of the difference: never negative.
    pub percent_as_printed: f64,
    /// True when the calibrated RMS is larger than the uncalibrated one.
    pub worse: bool,
}

/// Improvement of an RMS error by calibration: `100 |after - before| / before`, in percent.
///
/// `before_rms` is the RMS error without, `after_rms` with calibration, both in one unit. As printed
/// the formula takes a magnitude, so an error that doubled also reads 100 %; `worse` tells the two
/// apart. Source: Baser & Konukseven eq. (9).
///
/// # Errors
/// [`MetricsError::OutOfRange`] when `before_rms` is not positive or `after_rms` is negative,
/// [`MetricsError::NonFinite`] and [`MetricsError::Overflow`] as the names say.
///
/// # Examples
/// ```
/// use haptical_metrics::rms_improvement_percent;
/// let better = rms_improvement_percent(8.0, 2.0)?;
/// assert_eq!((better.percent_as_printed, better.worse), (75.0, false));
/// let worse = rms_improvement_percent(8.0, 14.0)?;
/// assert_eq!((worse.percent_as_printed, worse.worse), (75.0, true));
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn rms_improvement_percent(
    before_rms: f64,
    after_rms: f64,
) -> Result<RmsImprovement, MetricsError> {
    check_finite("before_rms", before_rms)?;
    check_finite("after_rms", after_rms)?;
    check_range("before_rms", before_rms, before_rms > 0.0, "greater than 0")?;
    check_range("after_rms", after_rms, after_rms >= 0.0, "at least 0")?;
    let percent = 100.0 * ((after_rms - before_rms).abs() / before_rms);
    Ok(RmsImprovement {
        percent_as_printed: finite_result("the RMS improvement", percent)?,
        worse: after_rms > before_rms,
    })
}

/// Reduction of a gap with the measurement noise taken out, in percent.
///
/// `100 (1 - sqrt(max(0, after^2 - floor^2) / (before^2 - floor^2)))`, where `before` and `after`
/// are RMS errors and `floor` the RMS of the noise, in one unit. 100 means that only noise is left.
/// Source: the definition of `reduction_percent` in `gap.json`.
///
/// Returns `None` where `before <= floor` (there is no gap to reduce), and for a negative or
/// non-finite argument.
///
/// # Examples
/// ```
/// use haptical_metrics::gap_reduction_percent;
/// // A gap of 4 under a noise of 3 reads 5; halving the gap leaves sqrt(4 + 9).
/// let percent = gap_reduction_percent(5.0, 13.0_f64.sqrt(), 3.0).ok_or("no gap")?;
/// assert!((percent - 50.0).abs() < 1e-12);
/// assert_eq!(gap_reduction_percent(3.0, 1.0, 3.0), None);
/// # Ok::<(), &str>(())
/// ```
pub fn gap_reduction_percent(before: f64, after: f64, floor: f64) -> Option<f64> {
    let valid = |value: f64| value.is_finite() && value >= 0.0;
    if !(valid(before) && valid(after) && valid(floor)) || before <= floor {
        return None;
    }
    // Differences of squares as products, over `before`: no cancellation, no overflow of squares.
    let (after_part, floor_part) = (after / before, floor / before);
    let left = ((after - floor) / before) * (after_part + floor_part);
    let initial = ((before - floor) / before) * (1.0 + floor_part);
    let percent = 100.0 * (1.0 - (left.max(0.0) / initial).sqrt());
    percent.is_finite().then_some(percent)
}
