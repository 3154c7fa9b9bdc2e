//! Errors of the library as exceptions of Python, with the same texts.

use haptical::ErrorKind;
use haptical::model::ModelError;
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

impl From<haptical::Error> for Failure {
    fn from(refused: haptical::Error) -> Self {
        let text = refused.to_string();
        // a keyword of a function is a flag of the command
        let text = text.strip_prefix("the command line: ").unwrap_or(&text);
        let text = text.to_owned();
        match refused.kind() {
            ErrorKind::NotFound => Self::NotFound(text),
            ErrorKind::Io => Self::System(text),
            ErrorKind::Unidentifiable => Self::Unidentifiable(text),
            _ => Self::Value(text),
        }
    }
}

impl From<ModelError> for Failure {
    fn from(error: ModelError) -> Self {
        Self::Value(error.to_string())
    }
}
