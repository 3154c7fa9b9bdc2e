//! The noise floor of a channel, and why a share of the gap above it may not be known.

use haptical_calibration::Channel;
use serde::Serialize;

use crate::noise::{NoiseSource, is_above};

/// The noise floor of a channel, with its source and its uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Floor {
    pub(crate) channel: Channel,
    /// Root mean square, in the channel's unit.
    pub(crate) rms: f64,
    pub(crate) freedom: f64,
    pub(crate) source: NoiseSource,
    /// It is not the one that residuals were weighted by, which is above all that the causes leave.
    pub(crate) is_another: bool,
    /// What is left of the channel is less, beyond chance, and no other source says how much of it is noise.
    pub(crate) is_contradicted: bool,
}

/// Why no share of a gap is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum NoReduction {
    /// The channel shows no gap.
    NoGap,
    /// The gap is no larger than the noise, within what both are known to.
    WithinNoise,
    /// Less is left than the noise floor, beyond chance: the floor is none.
    FloorContradicted,
    /// Nothing but what the model leaves says how large the noise is.
    NoiseUnknown,
    /// Nothing may be said of a gap: the log is not admitted to a verdict.
    NotJudged,
    /// Most of the gap is in rows of which no others determine a prediction, such as an event in one place.
    Undetermined,
}

impl NoReduction {
    /// In a few words.
    ///
    /// # Examples
    /// ```
    /// assert_eq!(haptical_diagnosis::NoReduction::NoGap.words(), "no gap");
    /// ```
    pub fn words(self) -> &'static str {
        match self {
            Self::NoGap => "no gap",
            Self::NotJudged => "not judged",
            Self::WithinNoise => "not known: within the noise",
            Self::FloorContradicted => "not known: less is left than the noise floor",
            Self::NoiseUnknown => "not known: nothing says how large the noise is",
            Self::Undetermined => "not known: no other rows predict those that show it",
        }
    }
}

impl Floor {
    /// The floor that residuals are weighted by, which nothing contradicts so far.
    pub(crate) fn new(channel: Channel, rms: f64, freedom: f64, source: NoiseSource) -> Self {
        Self {
            channel,
            rms,
            freedom,
            source,
            is_another: false,
            is_contradicted: false,
        }
    }

    /// The floor of a joint's rows that a fit did not see.
    pub(crate) fn of_rows(unseen: &haptical_motion::Unseen) -> Self {
        let channel = Channel::Output {
            joint: unseen.joint,
        };
        let freedom = (unseen.rows_in_all() as f64).max(1.0);
        Self::new(channel, unseen.noise, freedom, NoiseSource::Motion)
    }

    /// 95 % interval of a root mean square with degrees of freedom (Wilson & Hilferty 1931 on chi-square).
    pub(crate) fn ci95(&self) -> [f64; 2] {
        let part = 2.0 / (9.0 * self.freedom.max(1.0));
        let quantile = |z: f64| (1.0 - part + z * part.sqrt()).max(1e-3).powi(3);
        [1.96, -1.96].map(|z| self.rms / quantile(z).sqrt())
    }

    /// Whether it is larger than what is left on some readings, beyond chance.
    pub(crate) fn is_above(&self, rms: f64, freedom: f64) -> bool {
        is_above((self.rms, self.freedom), (rms, freedom))
    }

    /// Whether it says nothing of how much of a rest is noise.
    pub(crate) fn why_unknown(&self) -> Option<NoReduction> {
        match (self.is_contradicted, self.source) {
            (false, _) => None,
            (true, NoiseSource::Rest) => Some(NoReduction::NoiseUnknown),
            (true, _) => Some(NoReduction::FloorContradicted),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_repeats(rms: f64, freedom: f64) -> Floor {
        Floor::new(Channel::Position, rms, freedom, NoiseSource::Repeats)
    }

    #[test]
    fn a_floor_has_the_interval_of_its_freedom() {
        // chi-square of 10: 3.247 and 20.483
        let [low, high] = of_repeats(1.0, 10.0).ci95();
        assert!((low - (10.0_f64 / 20.483).sqrt()).abs() < 2e-3, "{low}");
        assert!((high - (10.0_f64 / 3.247).sqrt()).abs() < 2e-2, "{high}");
    }

    /// 97 % of a gap were said to close below a floor of twice what was left.
    #[test]
    fn a_floor_of_twice_the_rest_is_contradicted() {
        assert!(of_repeats(1.023e-3, 413.0).is_above(4.84e-4, 444.0));
        assert!(!of_repeats(1.023e-3, 413.0).is_above(1.0e-3, 444.0));
    }
}
