//! Errors of the libraries as exceptions of Python, with the same texts.

use haptical_calibration::CalibrationError;
use haptical_data::DataError;
use haptical_design::DesignError;
use haptical_diagnosis::DiagnosisError;
use haptical_identification::IdentificationError;
use haptical_model::{DeviceFileError, ModelError};
use haptical_urdf::UrdfError;
use pyo3::PyErr;
use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyFileNotFoundError, PyOSError, PyValueError};

create_exception!(
    haptical,
    HapticalError,
    PyException,
    "The numbers are sound, but nothing can be identified from them."
);

/// A refusal on its way to Python; made while the interpreter's lock is released.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Bad input: `ValueError`.
    Value(String),
    /// `FileNotFoundError`.
    NotFound(String),
    /// Another refusal of the operating system: `OSError`.
    System(String),
    /// Sound numbers that fix nothing: `HapticalError`.
    Unidentifiable(String),
}

impl Failure {
    pub(crate) fn value(text: impl Into<String>) -> Self {
        Self::Value(text.into())
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Value(text) => PyValueError::new_err(text),
            Failure::NotFound(text) => PyFileNotFoundError::new_err(text),
            Failure::System(text) => PyOSError::new_err(text),
            Failure::Unidentifiable(text) => HapticalError::new_err(text),
        }
    }
}

impl From<DataError> for Failure {
    fn from(error: DataError) -> Self {
        let text = error.to_string();
        match error {
            DataError::NotFound { .. } => Self::NotFound(text),
            DataError::Unreadable { .. } => Self::System(text),
            _ => Self::Value(text),
        }
    }
}

impl From<DeviceFileError> for Failure {
    fn from(error: DeviceFileError) -> Self {
        let text = error.to_string();
        match error {
            DeviceFileError::Unreadable { source, .. }
                if source.kind() == std::io::ErrorKind::NotFound =>
            {
                Self::NotFound(text)
            }
            DeviceFileError::Unreadable { .. } => Self::System(text),
            _ => Self::Value(text),
        }
    }
}

impl From<UrdfError> for Failure {
    fn from(error: UrdfError) -> Self {
        Self::Value(error.to_string())
    }
}

impl From<ModelError> for Failure {
    fn from(error: ModelError) -> Self {
        Self::Value(error.to_string())
    }
}

impl From<CalibrationError> for Failure {
    fn from(error: CalibrationError) -> Self {
        if error.is_unidentifiable() {
            return Self::Unidentifiable(error.to_string());
        }
        Self::Value(error.to_string())
    }
}

impl From<DesignError> for Failure {
    fn from(error: DesignError) -> Self {
        match error {
            DesignError::NothingIdentifiable { .. }
            | DesignError::Identification(IdentificationError::NothingFree) => {
                Self::Unidentifiable(error.to_string())
            }
            DesignError::Calibration(error) => Self::from(error),
            _ => Self::Value(error.to_string()),
        }
    }
}

impl From<DiagnosisError> for Failure {
    fn from(error: DiagnosisError) -> Self {
        let few = matches!(error, DiagnosisError::TooFewReadings { .. });
        if few || error.is_unidentifiable() {
            return Self::Unidentifiable(error.to_string());
        }
        Self::Value(error.to_string())
    }
}
