//! `haptical.doctor`: which joints and episodes of a recording are sound.

use std::path::PathBuf;

use pyo3::prelude::*;

use crate::failure::Failure;

/// The findings as a JSON text, which the package reads.
#[pyfunction]
#[pyo3(signature = (path, *, units=None, state=None, action=None))]
pub(crate) fn doctor(
    py: Python<'_>,
    path: PathBuf,
    units: Option<String>,
    state: Option<String>,
    action: Option<String>,
) -> PyResult<String> {
    let found = py.detach(|| {
        haptical_cli::doctor(
            &path,
            units.as_deref(),
            [state.as_deref(), action.as_deref()],
        )
    });
    Ok(found.map_err(Failure::from)?.to_string())
}
