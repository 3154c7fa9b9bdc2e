//! The noise of each stream, before anything is called a gap: its size and colour from what repeats of a posture or
//! successive rows of a motion do not share, and the rows that are outliers.
//!
//! docs/diagnosis.md, "Noise", derives the formulas.

mod repeats;
pub(crate) mod rounding;

mod colour;
mod estimate;
mod lines;
mod outliers;
mod spectrum;
mod speed;

use haptical_calibration::Channel;
use haptical_model::Device;
use serde::Serialize;

use crate::thresholds::noise::{BEYOND, MUCH_ROUNDING};

pub(crate) use self::estimate::{Known, estimate, of_two_parts, with_memory};
pub(crate) use self::lines::{Peak, lines, surest_peak, without_lines};
pub(crate) use self::outliers::{difference_sd, outliers, spread, without_readings};
pub(crate) use self::repeats::{Repeats, pooled};
pub(crate) use self::rounding::smallest_step;
pub(crate) use self::speed::speed_scale;

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
    /// Degrees of freedom that its size was estimated with.
    pub(crate) freedom: f64,
    /// What it was estimated from.
    pub(crate) source: NoiseSource,
    /// Increase of the standard deviation at the highest tenth of speeds over that at the lowest.
    pub(crate) speed_ratio: f64,
}

/// The noise of all streams, known from an earlier look.
#[derive(Debug, Clone)]
pub(crate) struct KnownNoise {
    pub(crate) noise: Vec<Noise>,
    /// Of each stream the factor of the deviation at each row, where it depends on the speed.
    pub(crate) scale: Vec<Option<Vec<f64>>>,
}

impl Noise {
    /// White, of single postures.
    fn of_postures(ratio: f64, freedom: f64, source: NoiseSource) -> Self {
        Self {
            ratio,
            colour: 0.0,
            coloured_share: 0.0,
            uncertainty: (2.0 / freedom).sqrt(),
            freedom,
            source,
            speed_ratio: 1.0,
        }
    }

    /// Rounding errors of a slow motion are slow themselves and pass for a signal within a segment: where
    /// they are much of the noise, its size is at least the stated one.
    pub(crate) fn with_rounding(mut self, share: f64) -> Self {
        if share > MUCH_ROUNDING {
            if self.ratio < 1.0 {
                // how much of the rounding there is in the residual is not known
                self.freedom = 2.0 / (2.0 / self.freedom + share * share);
            }
            self.ratio = self.ratio.max(1.0);
            self.uncertainty = self.uncertainty.hypot(0.2 * share);
        }
        self
    }

    /// A slow motion rests within a count for many rows, which a segment does not show: noise is no smaller than the `rounding` of the
    /// sensor's counts, given over the stated deviation, and that scatters as so many independent readings.
    pub(crate) fn with_counts(mut self, rounding: f64, readings: f64) -> Self {
        let share = (rounding / self.ratio.max(rounding)).powi(2);
        if rounding > self.ratio {
            self.ratio = rounding;
            self.source = NoiseSource::Counts;
        }
        let scatter = share * (2.0 / readings.max(1.0)).sqrt();
        self.uncertainty = self.uncertainty.hypot(scatter);
        self.freedom = 2.0 / (2.0 / self.freedom + scatter * scatter);
        self
    }

    /// Its level at low frequency, over the stated variance: what blocks average to.
    pub(crate) fn level(&self) -> f64 {
        let coloured = (1.0 + self.colour) / (1.0 - self.colour);
        let share = self.coloured_share;
        self.ratio * self.ratio * (share * coloured + 1.0 - share)
    }

    /// Independent rows in one row of noise of this colour.
    pub(crate) fn independent(&self) -> f64 {
        let colour = self.colour * self.coloured_share;
        (1.0 - colour * colour) / (1.0 + colour * colour)
    }

    /// Whether it is larger than a root mean square of as many degrees of freedom, beyond what both may err.
    pub(crate) fn is_above(&self, rms: f64, freedom: f64) -> bool {
        is_above((self.ratio, self.freedom), (rms, freedom))
    }
}

/// Whether one standard deviation is larger than another, each with its degrees of freedom, beyond what both may err: the
/// logarithm of a chi-square variance has the standard deviation sqrt(2 / freedom).
pub(crate) fn is_above(one: (f64, f64), other: (f64, f64)) -> bool {
    let spread = (2.0 / one.1.max(1.0) + 2.0 / other.1.max(1.0)).sqrt();
    2.0 * (one.0 / other.0.max(1e-300)).ln() > BEYOND * spread
}

#[cfg(test)]
mod tests;

/// What a noise floor was estimated from, the best source first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum NoiseSource {
    /// Postures that were recorded several times.
    Repeats,
    /// Successive rows of a motion.
    Motion,
    /// The counts of the encoder, which are more than successive rows of a slow motion show.
    Counts,
    /// The device file.
    Stated,
    /// All that the model leaves, gap and all: there is no other source.
    Rest,
}

impl NoiseSource {
    /// In words.
    ///
    /// # Examples
    /// ```
    /// assert_eq!(haptical_diagnosis::NoiseSource::Stated.words(), "the device file");
    /// ```
    pub fn words(self) -> &'static str {
        match self {
            Self::Repeats => "repeats of postures",
            Self::Motion => "differences of successive rows",
            Self::Counts => "the counts of the encoder",
            Self::Stated => "the device file",
            Self::Rest => "all that the model leaves",
        }
    }
}

/// Whether the device file says how noisy a channel is.
pub(crate) fn is_stated(device: &Device, channel: Channel) -> bool {
    match channel {
        Channel::Output { joint } => device.joints[joint].output_sd_rad().is_some(),
        Channel::Cable { index } => device.cable_sd_m(index).is_some(),
        Channel::Position => device.tracker.is_some_and(|t| t.position_sd_m.is_some()),
        Channel::Orientation => device.tracker.is_some_and(|t| t.rotation_sd_rad.is_some()),
        Channel::Contact => device.surroundings.contact_sd_m.is_some(),
        Channel::Plane => device.surroundings.plane_sd_m.is_some(),
        Channel::Fixture { .. } => device.surroundings.fixture_sd_rad.is_some(),
        Channel::ContactPair { .. } | Channel::PlanePair { .. } => true,
    }
}
