//! The command `haptical`, as the program of that name runs it.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the words of a command line, the program's name first, and gives the exit status.
#[pyfunction]
pub(crate) fn command(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| haptical_cli::run(words))
}
