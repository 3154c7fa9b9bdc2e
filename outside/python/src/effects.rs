//! `haptical.effects`: the effects that can be named, and be part of a device.

use haptical::effects::{Parameter, Spec, specs};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// Name, meaning, place, needs and parameters of each.
#[pyfunction]
pub(crate) fn effects(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    let all = PyList::empty(py);
    for spec in specs() {
        all.append(entry(py, spec)?)?;
    }
    Ok(all)
}

fn entry<'py>(py: Python<'py>, spec: &'static Spec) -> PyResult<Bound<'py, PyDict>> {
    let entry = PyDict::new(py);
    entry.set_item("name", spec.name)?;
    entry.set_item("enters", spec.hook.words())?;
    entry.set_item("meaning", spec.meaning)?;
    entry.set_item("inspect", spec.inspect)?;
    let needs: Vec<&str> = spec.needs.iter().map(|need| need.words()).collect();
    entry.set_item("needs", needs)?;
    let parameters = spec.parameters.iter().map(|own| parameter(py, own));
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
