//! `haptical.replay`: a recorded motion through a model, without fitting anything.

use haptical::replay as replay_log;
use numpy::PyArray1;
use numpy::PyArray2;
use numpy::ndarray::Array2;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::device::{Tips, device_of};
use crate::failure::Failure;
use crate::log::log_of;
use crate::serialised::dictionary;
use crate::watch::watched;

/// Channels by name, each with its residuals [N, axes], and warnings.
#[pyfunction]
#[pyo3(signature = (device, log, *, progress=None, base=None, tip=None, rig=None))]
pub(crate) fn replay<'py>(
    py: Python<'py>,
    device: &Bound<'py, PyAny>,
    log: &Bound<'py, PyAny>,
    progress: Option<&Bound<'py, PyAny>>,
    base: Option<&str>,
    tip: Option<Tips>,
    rig: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let device = device_of(device, (base, tip), rig)?;
    let log = log_of(log)?;
    let replayed = watched(py, progress, move |_| -> Result<_, Failure> {
        Ok(replay_log(&device.read, &log.read(&device.read)?)?)
    })??;
    let channels = PyDict::new(py);
    for channel in &replayed.channels {
        let entry = dictionary(py, serde_json::to_value(channel), &[])?;
        let rows = channel.residuals.iter();
        let rows = rows.map(|(row, _)| i64::try_from(*row).unwrap_or(i64::MAX));
        entry.set_item("rows", PyArray1::from_vec(py, rows.collect()))?;
        let axes = channel.residuals.first().map_or(1, |(_, axes)| axes.len());
        let of = |[row, axis]: [usize; 2]| channel.residuals[row].1[axis];
        let residuals = Array2::from_shape_fn((channel.residuals.len(), axes), |(row, axis)| {
            of([row, axis])
        });
        entry.set_item("residuals", PyArray2::from_owned_array(py, residuals))?;
        channels.set_item(&channel.channel, entry)?;
    }
    let answer = PyDict::new(py);
    answer.set_item("channels", channels)?;
    answer.set_item("warnings", &replayed.warnings)?;
    Ok(answer)
}
