//! Correlation of two series, of their values and of their ranks.

use crate::error::{MetricsError, check_same_length, check_values, largest_size};

/// Pearson's correlation of paired values, from -1 to 1, no unit.
///
/// `sum((x - mean x)(y - mean y)) / sqrt(sum((x - mean x)^2) sum((y - mean y)^2))`; `x[k]` and
/// `y[k]` are a pair. Source: any book on statistics.
///
/// # Errors
/// [`MetricsError::LengthMismatch`], [`MetricsError::TooFew`] for fewer than two pairs,
/// [`MetricsError::NonFinite`], [`MetricsError::ConstantSeries`] when one series does not vary.
///
/// # Examples
/// ```
/// let r = haptical_metrics::correlation(&[1.0, 2.0, 3.0], &[10.0, 8.0, 6.0])?;
/// assert!((r + 1.0).abs() < 1e-15);
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn correlation(x: &[f64], y: &[f64]) -> Result<f64, MetricsError> {
    check_pairs(x, y)?;
    let (x, y) = (unit_deviations("x", x)?, unit_deviations("y", y)?);
    Ok(x.iter()
        .zip(&y)
        .map(|(a, b)| a * b)
        .sum::<f64>()
        .clamp(-1.0, 1.0))
}

/// Spearman's correlation: Pearson's correlation of the ranks, from -1 to 1, no unit.
///
/// Equal values share the mean of the ranks they cover. It is 1 whenever `y` grows with `x`,
/// straight or not. Source: Spearman, The proof and measurement of association between two things,
/// 1904.
///
/// # Errors
/// As [`correlation`].
///
/// # Examples
/// ```
/// let r = haptical_metrics::spearman(&[1.0, 2.0, 3.0, 4.0], &[1.0, 8.0, 27.0, 64.0])?;
/// assert!((r - 1.0).abs() < 1e-15);
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn spearman(x: &[f64], y: &[f64]) -> Result<f64, MetricsError> {
    check_pairs(x, y)?;
    // Checked on the values, so that the error shows a value of the series and not a rank.
    let _ = (unit_deviations("x", x)?, unit_deviations("y", y)?);
    correlation(&ranks(x), &ranks(y))
}

fn check_pairs(x: &[f64], y: &[f64]) -> Result<(), MetricsError> {
    check_same_length(("x", x.len()), ("y", y.len()))?;
    check_values("x", x, 2)?;
    check_values("y", y, 2)
}

/// Deviations from the mean, scaled to a sum of squares of 1.
fn unit_deviations(what: &'static str, values: &[f64]) -> Result<Vec<f64>, MetricsError> {
    let constant = MetricsError::ConstantSeries {
        what,
        value: values[0],
    };
    // Compared directly: the mean of equal values may be off by a rounding, and would give noise.
    if values.iter().all(|&value| value == values[0]) {
        return Err(constant);
    }
    let largest = largest_size(values);
    let count = values.len() as f64;
    let mean = values
        .iter()
        .map(|value| value / largest / count)
        .sum::<f64>();
    let deviations: Vec<f64> = values.iter().map(|value| value / largest - mean).collect();
    let spread = largest_size(&deviations);
    if spread == 0.0 {
        return Err(constant);
    }
    let norm = deviations
        .iter()
        .map(|value| (value / spread).powi(2))
        .sum::<f64>()
        .sqrt();
    Ok(deviations
        .iter()
        .map(|value| value / spread / norm)
        .collect())
}

/// Rank of each value, from 1, with the mean rank for equal values.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    let mut start = 0;
    while start < order.len() {
        let value = values[order[start]];
        let ties = order[start..]
            .iter()
            .take_while(|&&index| values[index] == value)
            .count();
        let mean_rank = start as f64 + 0.5 * (ties as f64 + 1.0);
        for &index in &order[start..start + ties] {
            ranks[index] = mean_rank;
        }
        start += ties;
    }
    ranks
}
