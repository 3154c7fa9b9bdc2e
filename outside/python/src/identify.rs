//! `haptical.identify`: a calibration, its parameters and residuals as arrays.

use haptical_calibration::{Calibration, ChannelReport, ParameterFit, calibrate};
use haptical_identification::{Identifiability, Status};
use haptical_model::{Device as Model, ParameterId, TransmissionError};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::device::{device_of, log_shape};
use crate::failure::Failure;
use crate::log::log_of;
use crate::options::Keywords;

/// A calibration with the text of identified.toml and all warnings.
struct Outcome {
    calibration: Calibration,
    toml: String,
    warnings: Vec<String>,
    rows: usize,
}

/// Identifies the parameters of a device from a log; see the stub for arguments and result.
#[pyfunction]
#[pyo3(signature = (device, log, *, method="joint", held_out=0.2, degree=None, noise="estimated", loss="squares", tip=None, rig=None))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub(crate) fn identify<'py>(
    py: Python<'py>,
    device: &Bound<'py, PyAny>,
    log: &Bound<'py, PyAny>,
    method: &str,
    held_out: f64,
    degree: Option<&Bound<'py, PyAny>>,
    noise: &str,
    loss: &str,
    tip: Option<&str>,
    rig: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let options = Keywords {
        method,
        held_out,
        degree,
        noise,
        loss,
    }
    .options()?;
    let device = device_of(device, tip, rig)?;
    let log = log_of(log)?;
    let outcome = py.detach(|| -> Result<Outcome, Failure> {
        let read = log.read(&log_shape(&device.model))?;
        let calibration = calibrate(&device.model, &read.recording, &options)?;
        let toml = calibration.device.to_toml(&device.text, &device.label)?;
        let mut warnings = device.warnings.clone();
        warnings.extend(read.warnings);
        warnings.extend(calibration.warnings.iter().cloned());
        Ok(Outcome {
            calibration,
            toml,
            warnings,
            rows: read.recording.len(),
        })
    })?;
    result(py, &device.model, &outcome)
}

fn result<'py>(
    py: Python<'py>,
    nominal: &Model,
    outcome: &Outcome,
) -> PyResult<Bound<'py, PyDict>> {
    let calibration = &outcome.calibration;
    let fitted = &calibration.fitted;
    let steps: Vec<&ParameterFit> = fitted
        .transmissions
        .iter()
        .filter_map(|step| step.fit.as_ref())
        .collect();
    let fits: Vec<&ParameterFit> = match &fitted.whole {
        Some(whole) => vec![whole],
        None => steps.clone(),
    };
    let judged: Vec<&Identifiability> = fits.iter().map(|fit| &fit.identifiability).collect();
    let result = PyDict::new(py);
    result.set_item(
        "parameters",
        parameters(py, nominal, &calibration.device, &fits, &steps)?,
    )?;
    let held_out = &calibration.held_out_channels;
    let shown = if held_out.is_empty() {
        &calibration.fit_channels
    } else {
        held_out
    };
    result.set_item("channels", channels(py, shown)?)?;
    result.set_item("channels_fit", channels(py, &calibration.fit_channels)?)?;
    result.set_item("held_out", &calibration.held_out)?;
    result.set_item("rows", outcome.rows)?;
    result.set_item(
        "rank",
        judged.iter().map(|judged| judged.rank).sum::<usize>(),
    )?;
    result.set_item(
        "candidates",
        judged
            .iter()
            .map(|judged| judged.names.len())
            .sum::<usize>(),
    )?;
    result.set_item(
        "iterations",
        fits.iter().map(|fit| fit.iterations).sum::<usize>(),
    )?;
    result.set_item("warnings", &outcome.warnings)?;
    result.set_item("identified_toml", &outcome.toml)?;
    Ok(result)
}

/// The candidates of all fits, column by column.
fn parameters<'py>(
    py: Python<'py>,
    nominal: &Model,
    device: &Model,
    fits: &[&ParameterFit],
    steps: &[&ParameterFit],
) -> PyResult<Bound<'py, PyDict>> {
    let (names, keys, units) = (PyList::empty(py), PyList::empty(py), PyList::empty(py));
    let (statuses, reasons) = (PyList::empty(py), PyList::empty(py));
    let (mut was, mut values, mut deviations, mut ci95) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut seen: Vec<String> = Vec::new();
    // In two steps the whole fit has the kinematics alone; the transmissions come from step 1.
    for fit in fits.iter().chain(steps) {
        for (index, (&parameter, estimate)) in fit.parameters.iter().zip(&fit.estimates).enumerate()
        {
            let key = parameter.key(device);
            if seen.contains(&key) {
                continue;
            }
            names.append(&estimate.name)?;
            keys.append(&key)?;
            units.append(&estimate.unit)?;
            statuses.append(status_name(&estimate.status))?;
            reasons.append(fit.identifiability.reason(index))?;
            was.push(nominal_value(parameter, nominal, device).unwrap_or(f64::NAN));
            values.push(estimate.value.unwrap_or(f64::NAN));
            deviations.push(estimate.standard_deviation.unwrap_or(f64::NAN));
            ci95.push(estimate.ci95.unwrap_or([f64::NAN; 2]).to_vec());
            seen.push(key);
        }
    }
    let columns = PyDict::new(py);
    columns.set_item("name", names)?;
    columns.set_item("key", keys)?;
    columns.set_item("unit", units)?;
    columns.set_item("nominal", PyArray1::from_vec(py, was))?;
    columns.set_item("value", PyArray1::from_vec(py, values))?;
    columns.set_item("standard_deviation", PyArray1::from_vec(py, deviations))?;
    columns.set_item("ci95", pairs(py, &ci95)?)?;
    columns.set_item("status", statuses)?;
    columns.set_item("reason", reasons)?;
    Ok(columns)
}

/// Rows of two numbers as an array, of shape [0, 2] where there are none.
fn pairs<'py>(py: Python<'py>, rows: &[Vec<f64>]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    if rows.is_empty() {
        return Ok(PyArray2::zeros(py, [0, 2], false));
    }
    Ok(PyArray2::from_vec2(py, rows)?)
}

/// Value in the given device. A transmission error of zero is zero in every form; one of another form has no
/// such parameter.
fn nominal_value(parameter: ParameterId, nominal: &Model, device: &Model) -> Option<f64> {
    let ParameterId::Transmission { joint, .. } = parameter else {
        return Some(parameter.value(nominal));
    };
    let was = &nominal.joints[joint].transmission_error;
    let now = &device.joints[joint].transmission_error;
    let is_same_form = match (was, now) {
        (
            TransmissionError::Chebyshev {
                range_rad,
                coefficients,
            },
            TransmissionError::Chebyshev {
                range_rad: range,
                coefficients: found,
            },
        ) => range_rad == range && coefficients.len() == found.len(),
        _ => std::mem::discriminant(was) == std::mem::discriminant(now),
    };
    if is_same_form {
        Some(parameter.value(nominal))
    } else {
        (*was == TransmissionError::default()).then_some(0.0)
    }
}

fn status_name(status: &Status) -> &'static str {
    match status {
        Status::Identifiable { .. } => "identifiable",
        Status::Weak { .. } => "weak",
        Status::Invisible => "invisible",
        Status::Dependent { .. } => "dependent",
    }
}

fn channels<'py>(py: Python<'py>, reports: &[ChannelReport]) -> PyResult<Bound<'py, PyDict>> {
    let channels = PyDict::new(py);
    for report in reports {
        let entry = PyDict::new(py);
        entry.set_item("unit", &report.unit)?;
        entry.set_item("joint", report.joint)?;
        entry.set_item("readings", report.readings)?;
        entry.set_item("rms_before", report.rms_before)?;
        entry.set_item("rms_after", report.rms_after)?;
        entry.set_item("noise_floor", report.noise_floor)?;
        entry.set_item("reduction_percent", report.reduction_percent)?;
        let rows: Vec<i64> = report
            .rows
            .iter()
            .map(|&row| i64::try_from(row).unwrap_or(i64::MAX))
            .collect();
        entry.set_item("rows", PyArray1::from_vec(py, rows))?;
        entry.set_item("before", PyArray1::from_slice(py, &report.before))?;
        entry.set_item("after", PyArray1::from_slice(py, &report.after))?;
        channels.set_item(&report.channel, entry)?;
    }
    Ok(channels)
}
