//! The files that the command would write, in memory.

use haptical::files::NewFile;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

/// Their contents by name.
pub(crate) fn by_name<'py>(
    py: Python<'py>,
    files: &[NewFile<'static>],
) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    for (name, content) in files {
        all.set_item(name, PyBytes::new(py, content))?;
    }
    Ok(all)
}
