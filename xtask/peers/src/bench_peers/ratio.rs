//! Medians of pairwise ratios, with an interval from the order of the ratios alone.

use anyhow::Result;
use haptical_metrics::median;

/// Confidence that an interval should have; few rounds reach less and say so.
const CONFIDENCE: f64 = 0.95;

/// The median of a sample, and an interval for the median of what it was drawn from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MedianRatio {
    pub(crate) median: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// Probability that the interval holds the median, whatever the distribution.
    pub(crate) confidence: f64,
}

impl MedianRatio {
    /// The median of `ratios`, and the innermost pair of order statistics x_(k), x_(n+1-k) whose
    /// confidence 1 - 2 P(B < k), B binomial (n, 1/2), is at least 95 %; the outermost pair where
    /// none reaches it. Source: Conover, Practical Nonparametric Statistics, 1999, section 3.2.
    pub(crate) fn new(ratios: &[f64]) -> Result<Self> {
        let median = median(ratios)?;
        let mut sorted = ratios.to_vec();
        sorted.sort_by(f64::total_cmp);
        let count = sorted.len();
        // P(B < k) for k = 1, 2, ...
        let mut term = 0.5_f64.powi(i32::try_from(count)?);
        let mut below = term;
        let (mut rank, mut confidence) = (1, (1.0 - 2.0 * below).max(0.0));
        for k in 2..=count / 2 {
            term *= (count + 2 - k) as f64 / (k - 1) as f64;
            below += term;
            if 1.0 - 2.0 * below < CONFIDENCE {
                break;
            }
            (rank, confidence) = (k, 1.0 - 2.0 * below);
        }
        Ok(Self {
            median,
            low: sorted[rank - 1],
            high: sorted[count - rank],
            confidence,
        })
    }
}
