//! The noise of each stream, before anything is called a gap: its size and colour from what successive
//! rows do not share, and the rows that are outliers.
//!
//! docs/diagnosis.md, "Noise", derives the formulas.

pub(crate) mod cleaning;
pub(crate) mod measured;

mod colour;
mod lines;
mod outliers;
mod segments;
mod spectrum;
mod speed;

use std::ops::Range;

use self::colour::from_segments;
use self::segments::{segment_basis, segment_moments};
use crate::thresholds::noise::{
    ENOUGH_SEGMENTS, LAGS, MUCH_ROUNDING, SEGMENT_ROWS, STATED_UNCERTAINTY,
};

pub(crate) use self::lines::{lines, without_lines};
pub(crate) use self::outliers::{difference_sd, outliers};
pub(crate) use self::speed::speed_scale;

/// Noise of one stream.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Noise {
    /// Standard deviation over the stated one.
    pub(crate) ratio: f64,
    /// Correlation of successive rows of its coloured part (first-order autoregression).
    pub(crate) colour: f64,
    /// Share of the variance that is coloured; the rest is white (rounding, say).
    pub(crate) coloured_share: f64,
    /// Relative standard deviation of the estimated variance.
    pub(crate) uncertainty: f64,
    /// Estimated from differences within a motion; otherwise from all that the model leaves.
    pub(crate) from_motion: bool,
    /// Increase of the standard deviation at the highest tenth of speeds over that at the lowest.
    pub(crate) speed_ratio: f64,
}

impl Noise {
    /// White, of single postures.
    fn of_postures(ratio: f64, uncertainty: f64) -> Self {
        Self {
            ratio,
            colour: 0.0,
            coloured_share: 0.0,
            uncertainty,
            from_motion: false,
            speed_ratio: 1.0,
        }
    }

    /// Rounding errors of a slow motion are slow themselves and pass for a signal within a segment: where
    /// they are much of the noise, its size is at least the stated one.
    pub(crate) fn with_rounding(mut self, share: f64) -> Self {
        if share > MUCH_ROUNDING {
            self.ratio = self.ratio.max(1.0);
            self.uncertainty = self.uncertainty.hypot(0.2 * share);
        }
        self
    }
}

/// Estimates one stream's noise from its residuals over the stated standard deviation (NaN where
/// there is none), `lost` of which the model's parameters have taken.
pub(crate) fn estimate(
    scaled: &[f64],
    runs: &[Range<usize>],
    ordered: bool,
    lost: f64,
    stated: bool,
    rounding: f64,
) -> Noise {
    let series: Vec<Vec<f64>> = runs
        .iter()
        .map(|run| {
            let values = scaled[run.clone()].iter();
            values.copied().filter(|value| value.is_finite()).collect()
        })
        .collect();
    if ordered {
        let mut moments: Vec<[f64; LAGS]> = Vec::new();
        let basis = segment_basis();
        for run in &series {
            moments.extend(
                run.chunks_exact(SEGMENT_ROWS)
                    .map(|part| segment_moments(part, &basis)),
            );
        }
        if moments.len() >= ENOUGH_SEGMENTS {
            return from_segments(moments, rounding);
        }
    }
    let values: Vec<f64> = series.concat();
    if stated {
        // single postures cannot tell noise from a gap: the device file's figure is what there is
        return Noise::of_postures(1.0, STATED_UNCERTAINTY);
    }
    let freedom = (values.len() as f64 - lost).max(1.0);
    let sum: f64 = values.iter().map(|value| value * value).sum();
    let ratio = (sum / freedom).sqrt().max(1e-6);
    Noise::of_postures(ratio, (2.0 / freedom).sqrt())
}

#[cfg(test)]
mod tests;
