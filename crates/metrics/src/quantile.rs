//! Quantiles of a sample and the interval type that the other modules return.

use serde::{Deserialize, Serialize};

use crate::error::{MetricsError, check_level, check_range, check_values};

/// A closed interval, in the unit of the quantity it belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// True when `value` lies in the interval, ends included.
    pub fn contains(&self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// Length of the interval, in the unit of its ends.
    pub fn width(&self) -> f64 {
        self.high - self.low
    }
}

/// Sample quantile, in the unit of the values.
///
/// With the values sorted as `x_0 .. x_(n-1)` and `h = (n - 1) p`, the result is
/// `x_floor(h) + (h - floor(h)) (x_(floor(h)+1) - x_floor(h))`. Source: Hyndman & Fan, Sample
/// quantiles in statistical packages, 1996, type 7.
///
/// # Errors
/// [`MetricsError::TooFew`] for an empty slice, [`MetricsError::NonFinite`] for a NaN or infinity,
/// [`MetricsError::OutOfRange`] for `p` outside 0 to 1.
///
/// # Examples
/// ```
/// assert_eq!(haptical_metrics::quantile(&[4.0, 1.0, 3.0, 2.0], 0.25)?, 1.75);
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn quantile(values: &[f64], p: f64) -> Result<f64, MetricsError> {
    check_values("values", values, 1)?;
    check_range("p", p, (0.0..=1.0).contains(&p), "from 0 to 1")?;
    let mut values = values.to_vec();
    let (below, fraction) = place(values.len(), p);
    let (_, low, above) = values.select_nth_unstable_by(below, f64::total_cmp);
    let low = *low;
    let high = above.iter().copied().min_by(f64::total_cmp);
    Ok(between(low, high.unwrap_or(low), fraction))
}

/// Median of the values, in their unit: the quantile at 0.5.
///
/// # Errors
/// As [`quantile`].
pub fn median(values: &[f64]) -> Result<f64, MetricsError> {
    quantile(values, 0.5)
}

/// Central interval that holds the share `level` of the values, in their unit.
///
/// Its ends are the quantiles at `(1 - level) / 2` and `(1 + level) / 2`.
///
/// # Errors
/// [`MetricsError::TooFew`] for an empty slice, [`MetricsError::NonFinite`] for a NaN or infinity,
/// [`MetricsError::OutOfRange`] for `level` outside 0 to 1 (both excluded).
pub fn percentile_interval(values: &[f64], level: f64) -> Result<Interval, MetricsError> {
    check_values("values", values, 1)?;
    check_level(level)?;
    let sorted = sorted(values);
    Ok(Interval {
        low: sorted_quantile(&sorted, 0.5 * (1.0 - level)),
        high: sorted_quantile(&sorted, 0.5 * (1.0 + level)),
    })
}

/// The values in ascending order.
pub(crate) fn sorted(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

/// Type 7 quantile of sorted, finite, non-empty values; `p` is from 0 to 1.
pub(crate) fn sorted_quantile(sorted: &[f64], p: f64) -> f64 {
    let (below, fraction) = place(sorted.len(), p);
    let above = (below + 1).min(sorted.len() - 1);
    between(sorted[below], sorted[above], fraction)
}

/// Place of the value below a quantile among so many that are sorted, and how far the quantile is from there to the next.
fn place(count: usize, p: f64) -> (usize, f64) {
    let position = (count - 1) as f64 * p;
    let below = (position.floor() as usize).min(count - 1);
    (below, position - below as f64)
}

/// What lies this fraction of the way from one value to the next larger one.
fn between(low: f64, high: f64, fraction: f64) -> f64 {
    // The weighted form does not overflow, and the two guards keep it exact on ties and ends.
    if low == high || fraction == 0.0 {
        low
    } else {
        (low * (1.0 - fraction) + high * fraction).clamp(low, high)
    }
}
