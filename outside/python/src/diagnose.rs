//! `haptical.diagnose`: what a calibration leaves, and which effect causes it, as the fields of gap.json.

use std::collections::BTreeMap;

use haptical::{Diagnose, Log, diagnose as diagnose_device};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::device::{Tips, device_of, model_of};
use crate::failure::Failure;
use crate::files::by_name;
use crate::log::{log_of, logs_of};
use crate::options::{deviations_of, fits_compliance, loss_of};
use crate::watch::watched;

/// Diagnoses a device from a log; returns gap.json's fields and the text of corrected.toml as a JSON text, which the
/// package reads.
#[pyfunction]
#[pyo3(signature = (device, log, *, model=None, validate=None, without=Vec::new(), with_=Vec::new(), hold=Vec::new(), deviation=BTreeMap::new(), loss="auto", repair=false, progress=None, base=None, tip=None, rig=None))]
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
    repair: bool,
    progress: Option<&Bound<'_, PyAny>>,
    base: Option<&str>,
    tip: Option<Tips>,
    rig: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, Py<PyDict>)> {
    let (joint_compliance, loss) = (fits_compliance(&with_)?, loss_of(loss)?);
    let deviations = deviations_of(&deviation)?;
    let device = device_of(device, (base, tip), rig)?;
    let model = model.map(|model| model_of(model, &device)).transpose()?;
    let logs = logs_of(log)?;
    let validate = validate.map(log_of).transpose()?;
    let (text, files) = watched(py, progress, move |interrupt| -> Result<_, Failure> {
        let read = logs.iter().map(|log| log.read(&device.read));
        let read: Vec<Log> = read.collect::<Result<_, _>>()?;
        let Some((first, further)) = read.split_first() else {
            return Err(Failure::value(
                "the list of logs is empty; give one log or more",
            ));
        };
        let second = validate.map(|log| log.read(&device.read)).transpose()?;
        let request = Diagnose {
            without,
            model: model.as_ref().map(|model| &model.read),
            also: further.iter().collect(),
            validate: second.as_ref(),
            loss,
            joint_compliance,
            hold,
            deviations,
            repair,
            interrupt: interrupt.clone(),
            ..Diagnose::default()
        };
        let gap = diagnose_device(&device.read, first, &request)?;
        let refuse = |error: serde_json::Error| Failure::value(error.to_string());
        let mut told = serde_json::to_value(&gap.diagnosis).map_err(refuse)?;
        told["answer"] = gap.answer.as_str().into();
        told["corrected_toml"] = gap.corrected_toml().into();
        let text = serde_json::to_string(&told).map_err(refuse)?;
        Ok((text, gap.files()?))
    })??;
    Ok((text, by_name(py, &files)?.unbind()))
}
