//! What a noise floor was estimated from.

use serde::Serialize;

/// What a noise floor was estimated from, the best source first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum NoiseSource {
    /// Postures that were recorded several times.
    Repeats,
    /// Successive rows of a motion.
    Motion,
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
            Self::Stated => "the device file",
            Self::Rest => "all that the model leaves",
        }
    }
}
