//! `haptical.correct`: the commands that make a corrected arm go where a path wants it.

use haptical::{Correct, Match, Waypoints, correct as correct_path};
use numpy::ndarray::Array2;
use numpy::{PyArray1, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::device::{Tips, device_of, model_of};
use crate::failure::Failure;
use crate::log::{Log, log_of};
use crate::options::unknown;
use crate::watch::watched;

/// Commands [N, n], and how far each waypoint is left before and after.
#[pyfunction]
#[pyo3(signature = (device, model, waypoints, *, match_="auto", within_m=1e-6, within_rad=1e-6, progress=None, base=None, tip=None, rig=None))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub(crate) fn correct<'py>(
    py: Python<'py>,
    device: &Bound<'py, PyAny>,
    model: &Bound<'py, PyAny>,
    waypoints: &Bound<'py, PyAny>,
    match_: &str,
    within_m: f64,
    within_rad: f64,
    progress: Option<&Bound<'py, PyAny>>,
    base: Option<&str>,
    tip: Option<Tips>,
    rig: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let to_match = match match_ {
        "auto" => Match::Auto,
        "pose" => Match::Pose,
        "position" => Match::Position,
        other => return Err(unknown("match_", other, "auto, pose, position").into()),
    };
    for (name, size) in [("within_m", within_m), ("within_rad", within_rad)] {
        if !(size > 0.0 && size.is_finite()) {
            let text = format!("{name} is {size}; a size above 0 is expected");
            return Err(Failure::value(text).into());
        }
    }
    let device = device_of(device, (base, tip), rig)?;
    let model = model_of(model, &device)?;
    let path = log_of(waypoints)?;
    let request = Correct {
        to_match,
        within_m,
        within_rad,
    };
    let joints = device.read.model.joints.len();
    let (found, text) = watched(py, progress, move |_| -> Result<_, Failure> {
        let path = match &path {
            Log::File(file) => {
                Waypoints::read(&haptical::files::Source::by_path(file), &device.read)?
            }
            Log::Columns(_) => Waypoints::from_columns(&path.cells(), "the path", &device.read)?,
        };
        let found = correct_path(&device.read, &model.read, &path, &request)?;
        let text = found.to_csv()?;
        Ok((found, text))
    })??;
    let all = &found.waypoints;
    let result = PyDict::new(py);
    let commands =
        Array2::from_shape_fn((all.len(), joints), |(row, joint)| all[row].command[joint]);
    result.set_item("commands", commands.to_pyarray(py))?;
    let number = |of: &dyn Fn(&haptical::CorrectedWaypoint) -> Option<f64>| {
        let column = all.iter().map(|own| of(own).unwrap_or(f64::NAN));
        PyArray1::from_vec(py, column.collect())
    };
    result.set_item("before_m", number(&|own| own.before_m))?;
    result.set_item("before_rad", number(&|own| own.before_rad))?;
    result.set_item("rest_m", number(&|own| Some(own.rest_m)))?;
    result.set_item("rest_rad", number(&|own| own.rest_rad))?;
    result.set_item("with_orientations", found.with_orientations)?;
    result.set_item("warnings", &found.warnings)?;
    result.set_item("csv", String::from_utf8_lossy(&text))?;
    Ok(result)
}
