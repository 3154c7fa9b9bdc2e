//! The thresholds that every verdict rests on, from one versioned file.

use serde::Deserialize;

use crate::DiagnosisError;

/// Numbers of `thresholds.toml`; what each means stands there.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Thresholds {
    pub(crate) version: String,
    pub(crate) family_wise_p: f64,
    pub(crate) omnibus_z: f64,
    pub(crate) share_of_rest: f64,
    pub(crate) causes: usize,
    pub(crate) confusable_nats: f64,
    pub(crate) implausible_nats: f64,
    pub(crate) retained: f64,
    pub(crate) named_probability: f64,
    pub(crate) names: usize,
    pub(crate) outlier_sd: f64,
}

impl Thresholds {
    /// Those of this build.
    pub(crate) fn frozen() -> Result<Self, DiagnosisError> {
        toml::from_str(include_str!("../thresholds.toml")).map_err(|error| {
            DiagnosisError::Thresholds {
                reason: error.to_string(),
            }
        })
    }
}
