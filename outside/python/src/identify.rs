//! `haptical.identify`: what identified.json has, as dictionaries and arrays.

use std::collections::BTreeMap;

use haptical::calibration::ChannelReport;
use haptical::{Found, TransmissionEntry, identify as identify_device};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::{Value, json};

use crate::candidates::columns;
use crate::device::device_of;
use crate::failure::Failure;
use crate::log::log_of;
use crate::options::Keywords;
use crate::residuals::{channels, outliers};
use crate::serialised::{dictionary, python};

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
#[pyo3(signature = (device, log, *, method="joint", held_out=0.2, folds=None, with_=Vec::new(), hold=Vec::new(), deviation=BTreeMap::new(), degree=None, noise="estimated", loss="auto", base=None, tip=None, rig=None))]
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
    base: Option<&str>,
    tip: Option<&str>,
    rig: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
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
    let request = keywords.request()?;
    let device = device_of(device, (base, tip), rig)?;
    let log = log_of(log)?;
    let found = py.detach(|| -> Result<Found, Failure> {
        let read = log.read(&device.read)?;
        Ok(identify_device(&device.read, &read, &request)?)
    })?;
    result(py, &found)
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
    result.set_item("channels", channels(py, judged)?)?;
    result.set_item("channels_fit", channels(py, &calibration.fit_channels)?)?;
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
