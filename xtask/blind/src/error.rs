//! Errors while trials are drawn, sealed and scored.

use std::path::PathBuf;

use haptical_data::DataError;
use haptical_model::{DeviceFileError, ModelError};

/// Why a trial, a seal or a score cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BlindError {
    /// The device has no links or no joints, or a joint that slides.
    #[error("device `{device}`: {what}")]
    Device {
        /// Its name.
        device: String,
        /// What it lacks.
        what: &'static str,
    },
    /// A transmission has no value at an angle.
    #[error("the true device cannot be evaluated")]
    Model(#[from] ModelError),
    /// A device file that does not parse.
    #[error("a nominal device does not parse")]
    DeviceFile(#[from] DeviceFileError),
    /// A log that cannot be written.
    #[error("a log cannot be written")]
    Log(#[from] DataError),
    /// A file that cannot be written.
    #[error("{} cannot be written", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// No suite or effect of that name.
    #[error("there is no {kind} `{name}`; known are {known}")]
    Unknown {
        /// Suite or effect.
        kind: &'static str,
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// Text that is not what it should be.
    #[error("{what} cannot be turned into JSON or back")]
    Json {
        /// What was read.
        what: &'static str,
        /// The parser's reason.
        source: serde_json::Error,
    },
    /// The effect has no place on this device.
    #[error("`{effect}` has no place on device `{device}`")]
    NoPlace {
        /// The effect.
        effect: String,
        /// The device.
        device: String,
    },
    /// A truth that does not belong to its commitment.
    #[error("the truth does not match the commitment {commitment}")]
    Broken {
        /// The commitment, hexadecimal.
        commitment: String,
    },
}
