//! `haptical.identify`: a calibration, its parameters and residuals as arrays.

use haptical_calibration::{
    Calibration, ChannelReport, Outlier, ParameterFit, Robustness, calibrate,
};
use haptical_identification::{Identifiability, Loss, Status};
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
#[pyo3(signature = (device, log, *, method="joint", held_out=0.2, folds=None, with_=Vec::new(), degree=None, noise="estimated", loss="auto", tip=None, rig=None))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub(crate) fn identify<'py>(
    py: Python<'py>,
    device: &Bound<'py, PyAny>,
    log: &Bound<'py, PyAny>,
    method: &str,
    held_out: f64,
    folds: Option<&Bound<'py, PyAny>>,
    with_: Vec<String>,
    degree: Option<&Bound<'py, PyAny>>,
    noise: &str,
    loss: &str,
    tip: Option<&str>,
    rig: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let keywords = Keywords {
        method,
        held_out,
        folds,
        with: &with_,
        degree,
        noise,
        loss,
    };
    let options = keywords.options()?;
    let mut device = device_of(device, tip, rig)?;
    if keywords.fits_compliance()? {
        device.model.fit_compliance();
    }
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
    result(py, &outcome)
}

fn result<'py>(py: Python<'py>, outcome: &Outcome) -> PyResult<Bound<'py, PyDict>> {
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
    result.set_item("parameters", parameters(py, calibration, &fits, &steps)?)?;
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
    result.set_item("loss", loss(py, fitted.robust.as_ref())?)?;
    result.set_item("outliers", outliers(py, &calibration.outliers)?)?;
    result.set_item("warnings", &outcome.warnings)?;
    result.set_item("identified_toml", &outcome.toml)?;
    Ok(result)
}

/// What large residuals cost.
fn loss<'py>(py: Python<'py>, robust: Option<&Robustness>) -> PyResult<Bound<'py, PyDict>> {
    let entry = PyDict::new(py);
    let used = robust.map_or(Loss::Squares, |robust| robust.loss);
    entry.set_item("used", used.to_string())?;
    entry.set_item("rounds", robust.map_or(0, |robust| robust.rounds))?;
    entry.set_item("settled", robust.is_none_or(|robust| robust.settled))?;
    Ok(entry)
}

/// Readings that noise does not explain, farthest first, column by column.
fn outliers<'py>(py: Python<'py>, found: &[Outlier]) -> PyResult<Bound<'py, PyDict>> {
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

/// The candidates of all fits, column by column.
fn parameters<'py>(
    py: Python<'py>,
    calibration: &Calibration,
    fits: &[&ParameterFit],
    steps: &[&ParameterFit],
) -> PyResult<Bound<'py, PyDict>> {
    let (names, keys, units) = (PyList::empty(py), PyList::empty(py), PyList::empty(py));
    let (statuses, reasons) = (PyList::empty(py), PyList::empty(py));
    let (mut was, mut values, mut deviations, mut ci95) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut seen: Vec<&str> = Vec::new();
    // with the starts of the rig's unknown frames and places, which the log gave
    let (nominal, device) = (&calibration.nominal, &calibration.device);
    // In two steps the whole fit has the kinematics alone; the transmissions come from step 1.
    for fit in fits.iter().chain(steps) {
        for (index, (&parameter, estimate)) in fit.parameters.iter().zip(&fit.estimates).enumerate()
        {
            // not by key: the three turns of a frame share one
            if seen.contains(&estimate.name.as_str()) {
                continue;
            }
            names.append(&estimate.name)?;
            keys.append(parameter.key(device))?;
            units.append(&estimate.unit)?;
            statuses.append(status_name(&estimate.status))?;
            reasons.append(reason(fit, index))?;
            was.push(nominal_value(parameter, nominal, device).unwrap_or(f64::NAN));
            values.push(estimate.value.unwrap_or(f64::NAN));
            deviations.push(estimate.standard_deviation.unwrap_or(f64::NAN));
            ci95.push(estimate.ci95.unwrap_or([f64::NAN; 2]).to_vec());
            seen.push(&estimate.name);
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

/// Why a parameter has no value.
fn reason(fit: &ParameterFit, index: usize) -> Option<String> {
    let estimate = &fit.estimates[index];
    fit.identifiability.reason(index).or_else(|| {
        let held = || {
            format!(
                "{} was held: it could not be fitted at the nominal device",
                estimate.name
            )
        };
        estimate.value.is_none().then(held)
    })
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
