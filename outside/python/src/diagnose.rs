//! `haptical.diagnose`: what a calibration leaves, and which effect causes it, as the fields of gap.json.

use haptical::urdf::BaseAndTip;
use haptical::{Diagnose, diagnose as diagnose_device};
use pyo3::prelude::*;

use crate::device::device_of;
use crate::failure::Failure;
use crate::log::log_of;

/// Diagnoses a device from a log; returns gap.json's fields as a JSON text, which the package reads.
#[pyfunction]
#[pyo3(signature = (device, log, *, model=None, validate=None, without=Vec::new(), base=None, tip=None, rig=None))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub(crate) fn diagnose(
    py: Python<'_>,
    device: &Bound<'_, PyAny>,
    log: &Bound<'_, PyAny>,
    model: Option<&Bound<'_, PyAny>>,
    validate: Option<&Bound<'_, PyAny>>,
    without: Vec<String>,
    base: Option<&str>,
    tip: Option<&str>,
    rig: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    let device = device_of(device, BaseAndTip { base, tip }, rig)?;
    let model = model
        .map(|model| device_of(model, BaseAndTip::default(), None))
        .transpose()?;
    let log = log_of(log)?;
    let validate = validate.map(log_of).transpose()?;
    let text = py.detach(|| -> Result<String, Failure> {
        let read = log.read(&device.read)?;
        let second = validate.map(|log| log.read(&device.read)).transpose()?;
        let request = Diagnose {
            without,
            model: model.as_ref().map(|model| &model.read),
            validate: second.as_ref(),
            ..Diagnose::default()
        };
        let gap = diagnose_device(&device.read, &read, &request)?;
        serde_json::to_string(&gap.diagnosis).map_err(|error| Failure::value(error.to_string()))
    })?;
    Ok(text)
}
