//! `haptical.identify`: what identified.json has, as dictionaries and arrays.

use haptical_calibration::{Calibration, ForceDirection, ParameterFit, calibrate, without_copies};
use haptical_urdf::BaseAndTip;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;

use crate::candidates::{candidates, columns, not_identified};
use crate::device::device_of;
use crate::failure::Failure;
use crate::judgement::{
    correlations, force, force_leans, identifiability, intervals, noise, search,
};
use crate::log::log_of;
use crate::options::Keywords;
use crate::residuals::{channels, loss, outliers};
use crate::serialised::python;
use crate::transmissions::transmissions;

/// A calibration with the text of identified.toml and all warnings.
struct Outcome {
    calibration: Calibration,
    method: &'static str,
    force: Option<ForceDirection>,
    toml: String,
    warnings: Vec<String>,
    rows: usize,
}

/// Identifies the parameters of a device from a log; see the stub for arguments and result.
#[pyfunction]
#[pyo3(signature = (device, log, *, method="joint", held_out=0.2, folds=None, with_=Vec::new(), hold=Vec::new(), degree=None, noise="estimated", loss="auto", base=None, tip=None, rig=None))]
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
        degree,
        noise,
        loss,
    };
    let options = keywords.options()?;
    let mut device = device_of(device, BaseAndTip { base, tip }, rig)?;
    if keywords.fits_compliance()? {
        device.model.fit_compliance();
    }
    for word in &hold {
        device
            .model
            .hold(word)
            .map_err(|error| Failure::Value(error.to_string()))?;
    }
    let log = log_of(log)?;
    let outcome = py.detach(|| -> Result<Outcome, Failure> {
        let read = log.read(&device.model)?;
        let (recording, copies) = without_copies(read.recording);
        let calibration = calibrate(&device.model, &recording, &options)?;
        let force = force_leans(&device.model, &calibration, &recording)?;
        let toml = calibration.device.to_toml(&device.text, &device.label)?;
        let mut warnings = device.warnings.clone();
        warnings.extend(read.warnings);
        warnings.extend(copies);
        warnings.extend(calibration.warnings.iter().cloned());
        Ok(Outcome {
            calibration,
            method: Calibration::method_name(options.method),
            force,
            toml,
            warnings,
            rows: recording.len(),
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
    let found = candidates(calibration, &fits, &steps);
    let convergence = json!(fits.first().map(|fit| fit.convergence));
    let iterations: usize = fits.iter().map(|fit| fit.iterations).sum();
    let rank: usize = fits.iter().map(|fit| fit.identifiability.rank).sum();
    let count = fits.iter().map(|fit| fit.identifiability.names.len());
    let result = PyDict::new(py);
    result.set_item("method", outcome.method)?;
    result.set_item("rows", outcome.rows)?;
    result.set_item("held_out", &calibration.held_out)?;
    result.set_item("convergence", python(py, &convergence, &[])?)?;
    result.set_item("iterations", iterations)?;
    result.set_item("channels", channels(py, calibration.judged_channels())?)?;
    result.set_item("channels_fit", channels(py, &calibration.fit_channels)?)?;
    result.set_item("transmissions", transmissions(py, calibration, &found)?)?;
    let all: Vec<_> = found.iter().collect();
    result.set_item("parameters", columns(py, &all)?)?;
    result.set_item("not_identified", not_identified(py, &found)?)?;
    result.set_item("intervals", intervals(py, fits.first())?)?;
    result.set_item("search", search(py, calibration)?)?;
    result.set_item("identifiability", identifiability(py, &fits)?)?;
    result.set_item("correlations_above_0_95", correlations(&fits))?;
    result.set_item("force_direction", force(py, outcome.force.as_ref())?)?;
    result.set_item("noise", noise(py, &fitted.weights)?)?;
    result.set_item("loss", loss(py, fitted.robust.as_ref())?)?;
    result.set_item("outliers", outliers(py, &calibration.outliers)?)?;
    result.set_item("warnings", &outcome.warnings)?;
    // these two stood here before `identifiability` did
    result.set_item("rank", rank)?;
    result.set_item("candidates", count.sum::<usize>())?;
    result.set_item("identified_toml", &outcome.toml)?;
    Ok(result)
}
