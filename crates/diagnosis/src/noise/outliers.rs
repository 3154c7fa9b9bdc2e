//! Rows that stand alone, and a size of the noise that they cannot move.

use std::ops::Range;

use crate::thresholds::noise::MEDIAN_REACH;

/// Median of the magnitude of a normal deviate.
pub(super) const NORMAL_MEDIAN: f64 = 0.674_489_750_196_081_7;

/// Rows whose value stands alone: further than `limit` and what rounding adds, `rounded` of each row, from the median of
/// the seven rows around, which follow a motion, a jump or a drift.
pub(crate) fn outliers(
    scaled: &[f64],
    runs: &[Range<usize>],
    ordered: bool,
    limit: f64,
    rounded: &[f64],
) -> Vec<usize> {
    let mut found = Vec::new();
    for run in runs {
        let rows: Vec<usize> = run.clone().filter(|&row| scaled[row].is_finite()).collect();
        for (index, &row) in rows.iter().enumerate() {
            let centre = if ordered {
                let first = index.saturating_sub(MEDIAN_REACH);
                let end = (index + MEDIAN_REACH + 1).min(rows.len());
                let mut around: Vec<f64> = rows[first..end].iter().map(|&r| scaled[r]).collect();
                around.sort_by(f64::total_cmp);
                around[around.len() / 2]
            } else {
                0.0
            };
            if (scaled[row] - centre).abs() > limit + rounded[row] {
                found.push(row);
            }
        }
    }
    found
}

/// Median of the absolute differences of neighbours, as a standard deviation: a size of the noise
/// that outliers and gaps cannot move.
pub(crate) fn difference_sd(scaled: &[f64], runs: &[Range<usize>]) -> Option<f64> {
    let mut steps: Vec<f64> = Vec::new();
    for run in runs {
        let values: Vec<f64> = scaled[run.clone()]
            .iter()
            .copied()
            .filter(|value| value.is_finite())
            .collect();
        // second differences: a slope is not noise
        steps.extend(
            values
                .windows(3)
                .map(|w| (w[0] - 2.0 * w[1] + w[2]).abs() / 6.0_f64.sqrt()),
        );
    }
    let median = haptical_metrics::median(&steps).ok()?;
    Some(median / NORMAL_MEDIAN)
}
