//! `haptical.simulate`: a log of a true device, of a hand's motion or of single postures.

use haptical::data::{LogShape, write_log_to};
use haptical::design::Rig;
use haptical::effects::device::{add_effects, bare};
use haptical::model::Recording;
use haptical::simulator::{Effects, HandMotion, MotionSettings, add_tracker, record_motion};
use haptical::{Truth, simulate_postures, true_device};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::device::{Device, Tips, device_of, model_of};
use crate::failure::Failure;
use crate::log::{Log, log_of};
use crate::watch::watched;

/// Most rows of a log in memory, as the command has it for devices with effects.
const MOST_ROWS: f64 = 5e6;

/// What is simulated.
struct Made {
    csv: Vec<u8>,
    truth: String,
    rig: Option<String>,
    warnings: Vec<String>,
}

/// A simulated log as a table, the true device, and what reads it.
#[pyfunction]
#[pyo3(signature = (device, poses=None, *, measure=None, truth=None, deviate=None, effects=None, seconds=100.0, rate_hz=1000.0, seed=1, progress=None, base=None, tip=None, rig=None))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub(crate) fn simulate<'py>(
    py: Python<'py>,
    device: &Bound<'py, PyAny>,
    poses: Option<&Bound<'py, PyAny>>,
    measure: Option<String>,
    truth: Option<&Bound<'py, PyAny>>,
    deviate: Option<f64>,
    effects: Option<String>,
    seconds: f64,
    rate_hz: f64,
    seed: u64,
    progress: Option<&Bound<'py, PyAny>>,
    base: Option<&str>,
    tip: Option<Tips>,
    rig: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    if truth.is_some() && deviate.is_some() {
        return Err(
            Failure::value("truth and deviate exclude each other; give one of them").into(),
        );
    }
    if poses.is_none() && measure.is_some() {
        return Err(Failure::value("measure belongs to poses; leave it out").into());
    }
    if poses.is_some() && effects.is_some() {
        let text =
            "effects are of a hand's motion; with poses give them in truth, as its [[effect]]";
        return Err(Failure::value(text).into());
    }
    let device = device_of(device, (base, tip), rig)?;
    let truth = truth.map(|truth| model_of(truth, &device)).transpose()?;
    let poses = poses.map(log_of).transpose()?;
    let made = watched(py, progress, move |_| {
        let of = match (&truth, deviate) {
            (Some(truth), _) => Truth::Of(&truth.read),
            (None, Some(share)) => Truth::Drawn(share),
            (None, None) => Truth::Nominal,
        };
        match &poses {
            Some(poses) => postures(&device, of, poses, measure.as_deref(), seed),
            None => motion(&device, of, effects.as_deref(), (seconds, rate_hz), seed),
        }
    })??;
    let result = PyDict::new(py);
    result.set_item("csv", String::from_utf8_lossy(&made.csv))?;
    result.set_item("truth_toml", made.truth)?;
    result.set_item("rig_toml", made.rig)?;
    result.set_item("warnings", made.warnings)?;
    Ok(result)
}

fn table(recording: &Recording, shape: &LogShape) -> Result<Vec<u8>, Failure> {
    let mut csv = Vec::new();
    let written = write_log_to(&mut csv, recording, shape);
    written.map_err(|error| Failure::value(error.to_string()))?;
    Ok(csv)
}

fn text(truth: &haptical::model::Device) -> Result<String, Failure> {
    truth
        .to_new_toml()
        .map_err(|error| Failure::value(error.to_string()))
}

fn postures(
    device: &Device,
    truth: Truth<'_>,
    poses: &Log,
    measure: Option<&str>,
    seed: u64,
) -> Result<Made, Failure> {
    let rig = measure.map(Rig::parse).transpose();
    let rig = rig.map_err(|error| Failure::value(error.to_string()))?;
    let poses = poses.read(&device.read)?;
    let made = simulate_postures(&device.read, truth, &poses, rig.as_ref(), seed)?;
    Ok(Made {
        csv: table(&made.recording, &LogShape::from(&made.truth))?,
        truth: text(&made.truth)?,
        rig: made.rig,
        warnings: made.warnings,
    })
}

fn motion(
    device: &Device,
    truth: Truth<'_>,
    effects: Option<&str>,
    (seconds, rate_hz): (f64, f64),
    seed: u64,
) -> Result<Made, Failure> {
    device.read.refuse_hands("a simulated log")?;
    let rows = seconds * rate_hz;
    // NaN is no number of rows
    let is_allowed = rows > 0.0 && rows <= MOST_ROWS;
    if !is_allowed {
        let text = format!(
            "a log of {rows:e} rows is asked for; give other seconds or rate_hz: at most {MOST_ROWS:e} rows"
        );
        return Err(Failure::value(text));
    }
    let truth = true_device(&device.read, truth, seed)?;
    let settings = MotionSettings {
        motion: HandMotion {
            seconds,
            rate_hz,
            ..HandMotion::default()
        },
        ..MotionSettings::default()
    };
    let refuse = |error: &dyn std::fmt::Display| Failure::value(error.to_string());
    let own = match effects {
        None => Effects::none(),
        Some(own) => Effects::from_toml(own, "effects").map_err(|error| refuse(&error))?,
    };
    let mut rigid = bare(&truth);
    rigid.surroundings.compliance.clear();
    let made = record_motion(&rigid, &own, &settings, seed);
    let mut recording = made.map_err(|error| refuse(&error))?;
    add_tracker(&rigid, &mut recording, seed).map_err(|error| refuse(&error))?;
    add_effects(&truth, &mut recording).map_err(|error| refuse(&error))?;
    Ok(Made {
        csv: table(&recording, &LogShape::from(&truth))?,
        truth: text(&truth)?,
        rig: None,
        warnings: device.read.warnings.clone(),
    })
}
