//! Refusals of effects.

/// Why a list of effects, or `effects.toml`, is refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{place}: {what}")]
#[non_exhaustive]
pub struct EffectError {
    /// File, number of the effect (from 1) and its name, or the effect and its joint.
    pub place: String,
    /// What is wrong, and what is allowed.
    pub what: String,
}

impl EffectError {
    pub(crate) fn new(place: impl Into<String>, what: impl Into<String>) -> Self {
        let (place, what) = (place.into(), what.into());
        Self { place, what }
    }
}
