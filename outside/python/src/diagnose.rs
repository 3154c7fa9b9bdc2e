//! `haptical.diagnose`: what a calibration leaves, and which effect causes it, as the fields of gap.json.

use std::collections::BTreeMap;

use haptical::{Diagnose, diagnose as diagnose_device};
use pyo3::prelude::*;

use crate::device::{device_of, model_of};
use crate::failure::Failure;
use crate::log::log_of;
use crate::options::{deviations_of, fits_compliance, loss_of};

/// Diagnoses a device from a log; returns gap.json's fields and the text of corrected.toml as a JSON text, which the
/// package reads.
#[pyfunction]
#[pyo3(signature = (device, log, *, model=None, validate=None, without=Vec::new(), with_=Vec::new(), hold=Vec::new(), deviation=BTreeMap::new(), loss="auto", base=None, tip=None, rig=None))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub(crate) fn diagnose(
    py: Python<'_>,
    device: &Bound<'_, PyAny>,
    log: &Bound<'_, PyAny>,
    model: Option<&Bound<'_, PyAny>>,
    validate: Option<&Bound<'_, PyAny>>,
    without: Vec<String>,
    with_: Vec<String>,
    hold: Vec<String>,
    deviation: BTreeMap<String, f64>,
    loss: &str,
    base: Option<&str>,
    tip: Option<&str>,
    rig: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    let (joint_compliance, loss) = (fits_compliance(&with_)?, loss_of(loss)?);
    let deviations = deviations_of(&deviation)?;
    let device = device_of(device, (base, tip), rig)?;
    let model = model.map(|model| model_of(model, &device)).transpose()?;
    let log = log_of(log)?;
    let validate = validate.map(log_of).transpose()?;
    let text = py.detach(|| -> Result<String, Failure> {
        let read = log.read(&device.read)?;
        let second = validate.map(|log| log.read(&device.read)).transpose()?;
        let request = Diagnose {
            without,
            model: model.as_ref().map(|model| &model.read),
            validate: second.as_ref(),
            loss,
            joint_compliance,
            hold,
            deviations,
            ..Diagnose::default()
        };
        let gap = diagnose_device(&device.read, &read, &request)?;
        let refuse = |error: serde_json::Error| Failure::value(error.to_string());
        let mut told = serde_json::to_value(&gap.diagnosis).map_err(refuse)?;
        told["answer"] = gap.answer.as_str().into();
        told["corrected_toml"] = gap.corrected_toml().into();
        serde_json::to_string(&told).map_err(refuse)
    })?;
    Ok(text)
}
