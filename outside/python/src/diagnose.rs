//! `haptical.diagnose`: what a calibration leaves, and which effect causes it, as the fields of gap.json.

use haptical_diagnosis::{Options, diagnose as diagnose_recording};
use haptical_urdf::BaseAndTip;
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
        let read = log.read(&device.model)?;
        let validation = validate.map(|log| log.read(&device.model)).transpose()?;
        if let Some(model) = &model
            && (model.model.joints.len() != device.model.joints.len()
                || model.model.links.len() != device.model.links.len())
        {
            return Err(Failure::value(
                "the model has other joints or links than the device; give the identified model of this device",
            ));
        }
        let options = Options {
            without,
            model: model.as_ref().map(|model| &model.model),
            validation: validation.as_ref().map(|log| &log.recording),
        };
        let mut diagnosis = diagnose_recording(&device.model, &read.recording, &options)?;
        let mut warnings = device.warnings.clone();
        warnings.extend(model.iter().flat_map(|model| model.warnings.iter().cloned()));
        warnings.extend(read.warnings);
        warnings.extend(validation.into_iter().flat_map(|log| log.warnings));
        warnings.append(&mut diagnosis.warnings);
        diagnosis.warnings = warnings;
        serde_json::to_string(&diagnosis).map_err(|error| Failure::value(error.to_string()))
    })?;
    Ok(text)
}
