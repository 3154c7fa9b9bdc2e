//! `haptical.effects`: the effects that can be named, and be part of a device.

use haptical::effects::{Entry, Parameter, entries};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// Name, meaning, places, needs and parameters of each.
#[pyfunction]
pub(crate) fn effects(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    let all = PyList::empty(py);
    for named in entries() {
        all.append(entry(py, &named)?)?;
    }
    Ok(all)
}

fn entry<'py>(py: Python<'py>, named: &Entry) -> PyResult<Bound<'py, PyDict>> {
    let entry = PyDict::new(py);
    entry.set_item("name", named.name)?;
    entry.set_item("enters", named.enters.join(", "))?;
    entry.set_item("meaning", named.meaning)?;
    entry.set_item("inspect", named.inspect)?;
    entry.set_item("needs_any", &named.needs_any)?;
    let parameters = named.parameters.iter().map(|own| parameter(py, own));
    entry.set_item("parameters", parameters.collect::<PyResult<Vec<_>>>()?)?;
    Ok(entry)
}

fn parameter<'py>(py: Python<'py>, own: &Parameter) -> PyResult<Bound<'py, PyDict>> {
    let entry = PyDict::new(py);
    entry.set_item("name", own.name)?;
    entry.set_item("unit", own.unit.symbol())?;
    let ends = own.plausible.map(|end| (end < f64::MAX).then_some(end));
    entry.set_item("plausible", ends.to_vec())?;
    Ok(entry)
}
