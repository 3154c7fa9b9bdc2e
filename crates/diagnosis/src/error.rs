//! Errors of a diagnosis.

use haptical_calibration::CalibrationError;
use haptical_effects::ContextError;
use haptical_effects::device::DeviceEffectError;
use haptical_identification::IdentificationError;
use haptical_linalg::LinalgError;
use haptical_metrics::MetricsError;
use haptical_model::ModelError;

/// What a step of a diagnosis gives, or why there is no diagnosis.
pub(crate) type Result<T, E = DiagnosisError> = std::result::Result<T, E>;

/// Why there is no diagnosis.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DiagnosisError {
    /// The base model could not be fitted.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// The device has no value at a row.
    #[error("line {line} of the log: {source}")]
    Row {
        /// Line of the log.
        line: u64,
        /// Reason.
        source: ModelError,
    },
    /// The base model's equations have no value at a step of the refit.
    #[error("refit of the model with its effects: {0}")]
    Identification(#[from] IdentificationError),
    /// A decomposition was refused.
    #[error("diagnosis: {0}")]
    LinearAlgebra(#[from] LinalgError),
    /// A statistic was refused.
    #[error("diagnosis: {0}")]
    Metrics(#[from] MetricsError),
    /// A name that is not in the catalogue.
    #[error("there is no effect `{name}` in the catalogue{}", hint(.nearest))]
    UnknownEffect {
        /// As given.
        name: String,
        /// The name that it resembles most.
        nearest: Option<String>,
    },
    /// An effect of the device has no meaning.
    #[error(transparent)]
    Effect(#[from] DeviceEffectError),
    /// Too few readings are left for a test of anything.
    #[error(
        "{readings} usable readings cannot be tested against a model of {parameters} parameters: \
         record at least {advised} rows of slow motion through the whole range"
    )]
    TooFewReadings {
        /// Usable readings.
        readings: usize,
        /// Parameters of the base model.
        parameters: usize,
        /// Advised rows.
        advised: usize,
    },
    /// Torques are all that the log has, and nothing can be said of them.
    #[error("the log has joints and torques alone, and the torques cannot be tested: {why}")]
    Torques {
        /// Reason.
        why: String,
    },
    /// Joints and commands are all that the log has, and nothing can be said of them.
    #[error(
        "the log has joints and commands alone, and the answer to the commands cannot be tested: {why}"
    )]
    Commands {
        /// Reason.
        why: String,
    },
    /// Motors' currents cannot be compared with torques.
    #[error("the motors' currents cannot be tested: {why}")]
    Currents {
        /// Reason.
        why: String,
    },
    /// There is nothing that a further recording could tell apart.
    #[error("nothing to settle: {why}")]
    NothingToSettle {
        /// Reason.
        why: String,
    },
    /// An effect lists no shape: it can be fitted nowhere.
    #[error("the effect `{effect}` lists no shape: `Effect::shapes` must give at least one")]
    NoShape {
        /// Its name.
        effect: &'static str,
    },
}

fn hint(nearest: &Option<String>) -> String {
    nearest
        .as_ref()
        .map(|name| format!("; did you mean `{name}`?"))
        .unwrap_or_default()
}

impl DiagnosisError {
    /// Whether the numbers are in order but fix nothing (exit status 3 of the command).
    pub fn is_unidentifiable(&self) -> bool {
        match self {
            Self::Calibration(error) => error.is_unidentifiable(),
            Self::TooFewReadings { .. }
            | Self::Torques { .. }
            | Self::Commands { .. }
            | Self::Currents { .. } => true,
            _ => false,
        }
    }
}

impl From<ContextError> for DiagnosisError {
    fn from(error: ContextError) -> Self {
        match error {
            ContextError::Row { line, source } => Self::Row { line, source },
        }
    }
}
