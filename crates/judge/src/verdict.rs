//! The verdict.

use serde::Serialize;

use crate::thresholds::NAMED_PROBABILITY;

/// What is said of a gap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Nothing but noise is left.
    NoGap,
    /// The causes are named.
    Named,
    /// The data cannot tell the first cause from others.
    Ambiguous,
    /// There is a gap that no effect of the catalogue explains.
    Unknown,
}

impl Verdict {
    /// As in gap.json.
    pub fn name(self) -> &'static str {
        match self {
            Self::NoGap => "no-gap",
            Self::Named => "named",
            Self::Ambiguous => "ambiguous",
            Self::Unknown => "unknown",
        }
    }

    /// Whether there are causes: named ones, or one that others may be in the place of.
    pub fn has_causes(self) -> bool {
        matches!(self, Self::Named | Self::Ambiguous)
    }
}

/// What a verdict rests on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evidence {
    /// Whether some rows show more than noise.
    pub has_gap: bool,
    /// Whether what was found explains it, as far as that kind of rows can tell.
    pub is_supported: bool,
    /// Probability of the first cause at its place; none without a cause.
    pub probability: Option<f64>,
}

/// The verdict.
pub fn verdict(evidence: Evidence) -> Verdict {
    match evidence.probability {
        _ if !evidence.has_gap => Verdict::NoGap,
        Some(probability) if evidence.is_supported => match probability >= NAMED_PROBABILITY {
            true => Verdict::Named,
            false => Verdict::Ambiguous,
        },
        _ => Verdict::Unknown,
    }
}
