//! Residuals of the channels before and after, and those that noise does not explain.

use haptical::calibration::{ChannelReport, Outlier};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::serialised::dictionary;

/// Reports by the channels' names.
pub(crate) fn channels<'py>(
    py: Python<'py>,
    reports: &[ChannelReport],
) -> PyResult<Bound<'py, PyDict>> {
    let channels = PyDict::new(py);
    for report in reports {
        let entry = dictionary(py, serde_json::to_value(report), &[])?;
        let rows = report.rows.iter();
        let rows = rows.map(|&row| i64::try_from(row).unwrap_or(i64::MAX));
        entry.set_item("rows", PyArray1::from_vec(py, rows.collect()))?;
        entry.set_item("before", PyArray1::from_slice(py, &report.before))?;
        entry.set_item("after", PyArray1::from_slice(py, &report.after))?;
        channels.set_item(&report.channel, entry)?;
    }
    Ok(channels)
}

/// Readings that noise does not explain, farthest first, column by column.
pub(crate) fn outliers<'py>(py: Python<'py>, found: &[Outlier]) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    let lines = found
        .iter()
        .map(|wild| i64::try_from(wild.line).unwrap_or(i64::MAX));
    let channels: Vec<String> = found.iter().map(|wild| wild.channel.name()).collect();
    let residuals: Vec<f64> = found.iter().map(|wild| wild.residual).collect();
    let deviations: Vec<f64> = found.iter().map(|wild| wild.deviations).collect();
    columns.set_item("line", PyArray1::from_vec(py, lines.collect::<Vec<_>>()))?;
    columns.set_item("channel", channels)?;
    columns.set_item("residual", PyArray1::from_vec(py, residuals))?;
    columns.set_item("deviations", PyArray1::from_vec(py, deviations))?;
    Ok(columns)
}
