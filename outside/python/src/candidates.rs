//! Candidate parameters column by column: values, intervals, and why some have none.

use haptical::ParameterEntry;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use serde_json::json;

use crate::serialised::python;

/// The candidates column by column; NaN where there is no number.
pub(crate) fn columns<'py>(
    py: Python<'py>,
    candidates: &[ParameterEntry],
) -> PyResult<Bound<'py, PyDict>> {
    let text = |of: fn(&ParameterEntry) -> &str| PyList::new(py, candidates.iter().map(of));
    let number = |of: fn(&ParameterEntry) -> Option<f64>| {
        let numbers = candidates.iter().map(|one| of(one).unwrap_or(f64::NAN));
        PyArray1::from_vec(py, numbers.collect())
    };
    let combinations = candidates.iter().map(|one| &one.combination);
    let reasons = candidates.iter().map(|one| one.reason.as_deref());
    let columns = PyDict::new(py);
    columns.set_item("name", text(|one| &one.name)?)?;
    columns.set_item("key", text(|one| &one.key)?)?;
    columns.set_item("unit", text(|one| &one.unit)?)?;
    columns.set_item("nominal", number(|one| one.nominal))?;
    columns.set_item("value", number(|one| one.value))?;
    columns.set_item("deviation", number(|one| one.deviation))?;
    columns.set_item("standard_deviation", number(|one| one.standard_deviation))?;
    columns.set_item("ci95", intervals(py, candidates)?)?;
    columns.set_item("plausible_size", number(|one| Some(one.plausible_size)))?;
    columns.set_item("status", text(|one| one.status)?)?;
    let combinations = json!(combinations.collect::<Vec<_>>());
    columns.set_item("combination", python(py, &combinations, &[])?)?;
    columns.set_item("reason", reasons.collect::<Vec<_>>())?;
    Ok(columns)
}

/// The 95 % intervals as rows, of shape [0, 2] where there are none.
fn intervals<'py>(
    py: Python<'py>,
    candidates: &[ParameterEntry],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    if candidates.is_empty() {
        return Ok(PyArray2::zeros(py, [0, 2], false));
    }
    let row = |one: &ParameterEntry| one.ci95.unwrap_or([f64::NAN; 2]).to_vec();
    let rows: Vec<_> = candidates.iter().map(row).collect();
    Ok(PyArray2::from_vec2(py, &rows)?)
}
