//! The noise of each stream, before anything is called a gap: its size and colour from what successive
//! rows do not share, and the rows that are outliers.
//!
//! docs/diagnosis.md, "Noise", derives the formulas.

pub(crate) mod cleaning;
pub(crate) mod measured;
pub(crate) mod stated;

mod colour;
mod estimate;
mod lines;
mod outliers;
mod segments;
mod spectrum;
mod speed;

use crate::thresholds::noise::MUCH_ROUNDING;

pub(crate) use self::estimate::estimate;
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

#[cfg(test)]
mod tests;
