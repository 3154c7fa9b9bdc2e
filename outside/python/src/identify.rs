//! `haptical.identify`: what identified.json has, as dictionaries and arrays.

use std::collections::BTreeMap;

use haptical::calibration::ChannelReport;
use haptical::files::NewFile;
use haptical::{
    DYNAMICS, Found, FoundDynamics, InputDrumDenominators, TransmissionEntry,
    identify as identify_device, identify_dynamics,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::{Value, json};

use crate::candidates::columns;
use crate::device::{Tips, device_of, with_denominators};
use crate::failure::Failure;
use crate::files::by_name;
use crate::log::log_of;
use crate::options::Keywords;
use crate::residuals::{channels, outliers};
use crate::serialised::{dictionary, python};
use crate::watch::watched;

/// Keys of the numbers in a row.
const ARRAYS: [&str; 5] = [
    "singular_values",
    "gap",
    "ci95_rad",
    "range_rad",
    "polynomial_monomials",
];
/// What is about files alone.
const OF_FILES: [&str; 4] = ["haptical_version", "device", "log", "provenance"];

/// Identifies the parameters of a device from a log; see the stub for arguments and result.
#[pyfunction]
#[pyo3(signature = (device, log, *, method="joint", held_out=0.2, folds=None, with_=Vec::new(), hold=Vec::new(), deviation=BTreeMap::new(), degree=None, noise="estimated", loss="auto", validate=None, band_hz=None, input_drum_denominator_m=None, paper_preset=false, progress=None, base=None, tip=None, rig=None))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub(crate) fn identify<'py>(
    py: Python<'py>,
    device: &Bound<'py, PyAny>,
    log: &Bound<'py, PyAny>,
    method: &str,
    held_out: f64,
    folds: Option<&Bound<'py, PyAny>>,
    with_: Vec<String>,
    hold: Vec<String>,
    deviation: BTreeMap<String, f64>,
    degree: Option<&Bound<'py, PyAny>>,
    noise: &str,
    loss: &str,
    validate: Option<&Bound<'py, PyAny>>,
    band_hz: Option<f64>,
    input_drum_denominator_m: Option<f64>,
    paper_preset: bool,
    progress: Option<&Bound<'py, PyAny>>,
    base: Option<&str>,
    tip: Option<Tips>,
    rig: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let is_of_dynamics = of_dynamics(&with_, validate.is_some() || band_hz.is_some())?;
    let denominators = denominators(input_drum_denominator_m, paper_preset)?;
    let keywords = Keywords {
        method,
        held_out,
        folds,
        with: &with_,
        hold: &hold,
        deviation: &deviation,
        degree,
        noise,
        loss,
    };
    let mut request = keywords.request()?;
    let device = with_denominators(device_of(device, (base, tip), rig)?, denominators)?;
    let log = log_of(log)?;
    let validate = validate.map(log_of).transpose()?;
    if is_of_dynamics {
        let found = watched(py, progress, move |_| -> Result<_, Failure> {
            let read = log.read(&device.read)?;
            let second = validate.map(|log| log.read(&device.read)).transpose()?;
            let found = identify_dynamics(&device.read, &read, second.as_ref(), band_hz)?;
            let files = found.files()?;
            Ok((found, files))
        })??;
        return dynamics(py, &found.0, &found.1);
    }
    let found = watched(py, progress, move |interrupt| -> Result<_, Failure> {
        request.options.search.interrupt = interrupt.clone();
        let read = log.read(&device.read)?;
        let found = identify_device(&device.read, &read, &request)?;
        let files = found.files()?;
        Ok((found, files))
    })??;
    let result = result(py, &found.0)?;
    result.set_item("_files", by_name(py, &found.1)?)?;
    Ok(result)
}

/// Whether the dynamics are asked for, and what goes with them alone.
fn of_dynamics(with: &[String], is_extra: bool) -> Result<bool, Failure> {
    let is_asked = with.iter().any(|word| word == DYNAMICS);
    if is_asked && with.len() > 1 {
        return Err(Failure::value(
            "with_ has \"dynamics\" beside other effects; give it alone",
        ));
    }
    if is_extra && !is_asked {
        let text = "validate and band_hz belong to with_=[\"dynamics\"]; leave them out";
        return Err(Failure::value(text));
    }
    Ok(is_asked)
}

fn denominators(same_m: Option<f64>, paper: bool) -> Result<InputDrumDenominators, Failure> {
    match (same_m, paper) {
        (Some(_), true) => Err(Failure::value(
            "input_drum_denominator_m and paper_preset exclude each other; give one of them",
        )),
        (Some(length_m), false) if length_m > 0.0 && length_m.is_finite() => {
            Ok(InputDrumDenominators::Same(length_m))
        }
        (Some(length_m), false) => Err(Failure::value(format!(
            "input_drum_denominator_m is {length_m}; a length in m above 0 is expected"
        ))),
        (None, true) => Ok(InputDrumDenominators::Paper),
        (None, false) => Ok(InputDrumDenominators::Stated),
    }
}

/// The fields of identified.json of an identification of the dynamics.
fn dynamics<'py>(
    py: Python<'py>,
    found: &FoundDynamics,
    files: &[NewFile<'static>],
) -> PyResult<Bound<'py, PyDict>> {
    let serialised = serde_json::to_value(&found.result);
    let serialised = serialised.map_err(|error| Failure::value(error.to_string()))?;
    let result = PyDict::new(py);
    for (key, value) in serialised.as_object().into_iter().flatten() {
        if !OF_FILES.contains(&key.as_str()) {
            result.set_item(key, python(py, value, &ARRAYS)?)?;
        }
    }
    result.set_item("identified_toml", found.device.to_toml())?;
    result.set_item("_files", by_name(py, files)?)?;
    Ok(result)
}

/// The fields of identified.json; what are records there are columns here, and channels have their residuals.
fn result<'py>(py: Python<'py>, found: &Found) -> PyResult<Bound<'py, PyDict>> {
    let content = &found.result;
    let serialised = serde_json::to_value(content);
    let serialised = serialised.map_err(|error| Failure::value(error.to_string()))?;
    let result = PyDict::new(py);
    for (key, value) in serialised.as_object().into_iter().flatten() {
        if !OF_FILES.contains(&key.as_str()) {
            result.set_item(key, python(py, value, &ARRAYS)?)?;
        }
    }
    // identified.json's channels have no residuals, the calibration's have
    let calibration = &found.calibration;
    let judged: &[ChannelReport] = calibration.judged_channels();
    let of_fit = &calibration.fit_channels;
    for (key, reports, figures) in [
        ("channels", judged, &content.channels),
        ("channels_fit", of_fit, &content.channels_fit),
    ] {
        let channels = channels(py, reports)?;
        // the result's alone know what the fit leaves
        for own in figures {
            if let Some(entry) = channels.get_item(&own.channel)? {
                entry.set_item("rms_fit", own.rms_fit)?;
            }
        }
        result.set_item(key, channels)?;
    }
    let entries = content.transmissions.iter();
    let entries = entries.map(|entry| transmission(py, entry));
    result.set_item("transmissions", entries.collect::<PyResult<Vec<_>>>()?)?;
    result.set_item("parameters", columns(py, &content.parameters)?)?;
    let correlations = content.correlations_above_0_95.clone();
    result.set_item("correlations_above_0_95", correlations)?;
    result.set_item("outliers", outliers(py, &content.outliers)?)?;
    // these two stood here before `identifiability` did
    result.set_item("rank", content.identifiability.solution.rank)?;
    result.set_item("candidates", content.identifiability.solution.candidates)?;
    result.set_item("identified_toml", found.to_toml())?;
    Ok(result)
}

fn transmission<'py>(py: Python<'py>, entry: &TransmissionEntry) -> PyResult<Bound<'py, PyDict>> {
    let value = serde_json::to_value(entry).map(|mut value| {
        if entry.polynomial_monomials.is_none() {
            value["polynomial_monomials"] = Value::Null;
        }
        value["parameters"] = json!(null);
        value
    });
    let dictionary = dictionary(py, value, &ARRAYS)?;
    dictionary.set_item("parameters", columns(py, &entry.parameters)?)?;
    Ok(dictionary)
}
