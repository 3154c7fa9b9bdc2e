//! `haptical.plan`: what rigs tell before anything is measured, and the poses to measure next as an array.

use std::path::PathBuf;

use haptical::design::{
    Figures, NextPoses, ParameterStatus, Posture, RigIdentifiability, Suggestion,
};
use haptical::files::{NewFile, Source};
use haptical::{GapFile, Planned, SettleRequest, plan as plan_device, settle as settle_device};
use numpy::ndarray::Array2;
use numpy::{PyArray1, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::device::{Device, Tips, device_of};
use crate::failure::Failure;
use crate::files::by_name;
use crate::log::{Log, logs_of};
use crate::plan_options::Keywords;
use crate::serialised::dictionary;
use crate::watch::watched;

/// Plans for a device; see the stub for arguments and result.
#[pyfunction]
#[pyo3(signature = (
    device, measure, *, poses=None, criterion="d", region=None, candidates=None, seed=None, spread="uniform",
    workspace=None, cable_length=None, link_radius=None, known_transmissions=false, log=None,
    settle=None, rows=None, press=None, progress=None, base=None, tip=None, rig=None
))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub(crate) fn plan<'py>(
    py: Python<'py>,
    device: &Bound<'py, PyAny>,
    measure: Vec<String>,
    poses: Option<&Bound<'py, PyAny>>,
    criterion: &str,
    region: Option<&Bound<'py, PyAny>>,
    candidates: Option<&Bound<'py, PyAny>>,
    seed: Option<&Bound<'py, PyAny>>,
    spread: &str,
    workspace: Option<&Bound<'py, PyAny>>,
    cable_length: Option<&Bound<'py, PyAny>>,
    link_radius: Option<f64>,
    known_transmissions: bool,
    log: Option<&Bound<'py, PyAny>>,
    settle: Option<&Bound<'py, PyAny>>,
    rows: Option<usize>,
    press: Option<f64>,
    progress: Option<&Bound<'py, PyAny>>,
    base: Option<&str>,
    tip: Option<Tips>,
    rig: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    if settle.is_none() && (rows.is_some() || press.is_some()) {
        let text = "rows and press belong to settle; leave them out";
        return Err(Failure::value(text).into());
    }
    let has_rigs = !measure.is_empty() || poses.is_some() || known_transmissions;
    let candidates_asked = candidates.is_some();
    let request = Keywords {
        measure,
        poses,
        criterion,
        region,
        candidates,
        seed,
        spread,
        workspace,
        cable_length,
        link_radius,
        known_transmissions,
    }
    .request()?;
    let device = device_of(device, (base, tip), rig)?;
    let joints = device.read.model.joints.len();
    let logs = log.map(logs_of).transpose()?.unwrap_or_default();
    if let Some(gap) = settle {
        if has_rigs {
            let text =
                "settle goes with neither measure, poses nor known_transmissions; leave them out";
            return Err(Failure::value(text).into());
        }
        let usual = SettleRequest::default();
        let request = SettleRequest {
            rows,
            candidates: if candidates_asked {
                request.candidates
            } else {
                usual.candidates
            },
            limits: request.limits,
            seed: request.seed,
            press_n: press,
        };
        let gap = gap_of(gap)?;
        let files = watched(py, progress, move |_| {
            settled(&device, &logs, &gap, &request)
        })??;
        return json(py, &files);
    }
    if logs.len() > 1 {
        return Err(Failure::value("a plan of rigs adds to one log; give one, or settle").into());
    }
    let (planned, files) = watched(py, progress, move |_| -> Result<_, Failure> {
        let read = logs.first().map(|log| log.read(&device.read)).transpose()?;
        let planned = plan_device(&device.read, &request, read.as_ref())?;
        let files = planned.files()?;
        Ok((planned, files))
    })??;
    let result = result(py, joints, criterion, &planned)?;
    result.set_item("_files", by_name(py, &files)?)?;
    Ok(result)
}

/// A gap.json: its path, or a diagnosis, which is written as one.
fn gap_of(gap: &Bound<'_, PyAny>) -> PyResult<Source> {
    if let Ok(files) = gap.getattr("files") {
        let content: Vec<u8> = files.get_item("gap.json")?.extract()?;
        let text = String::from_utf8_lossy(&content).into_owned();
        return Ok(Source::text(text, "gap.json"));
    }
    Ok(Source::by_path(&gap.extract::<PathBuf>()?))
}

fn settled(
    device: &Device,
    logs: &[Log],
    gap: &Source,
    request: &SettleRequest,
) -> Result<Vec<NewFile<'static>>, Failure> {
    let gap = GapFile::open(gap)?;
    let read = logs.iter().map(|log| log.read(&device.read));
    let read: Vec<haptical::Log> = read.collect::<Result<_, _>>()?;
    if read.is_empty() {
        return Err(Failure::value("settle needs log, the log of the diagnosis"));
    }
    let all: Vec<&haptical::Log> = read.iter().collect();
    Ok(settle_device(&device.read, &all, &gap, request)?.files()?)
}

/// The fields of plan.json.
fn json<'py>(py: Python<'py>, files: &[NewFile<'static>]) -> PyResult<Bound<'py, PyDict>> {
    let plan = files.iter().find(|(name, _)| name.ends_with(".json"));
    let content = plan.map_or(&b"{}"[..], |(_, content)| content);
    let result = dictionary(py, serde_json::from_slice(content), &[])?;
    result.set_item("_files", by_name(py, files)?)?;
    Ok(result)
}

fn result<'py>(
    py: Python<'py>,
    joints: usize,
    criterion: &str,
    Planned { plan, warnings, .. }: &Planned,
) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    result.set_item("poses", plan.poses)?;
    result.set_item("measured_poses", plan.measured_poses)?;
    let rigs = plan.rigs.iter().map(|rig| rig_entry(py, rig));
    let rigs: Vec<_> = rigs.collect::<PyResult<_>>()?;
    result.set_item("rigs", rigs)?;
    let next = plan.next_poses.as_ref();
    let next = next.map(|next| next_poses(py, joints, criterion, next));
    let next = next.transpose()?;
    result.set_item("next_poses", next)?;
    result.set_item("warnings", warnings)?;
    Ok(result)
}

fn rig_entry<'py>(py: Python<'py>, rig: &RigIdentifiability) -> PyResult<Bound<'py, PyDict>> {
    let entry = PyDict::new(py);
    entry.set_item("measure", &rig.measure)?;
    entry.set_item("readings_per_pose", rig.readings_per_pose)?;
    entry.set_item("rank", rig.rank)?;
    entry.set_item("parameters", parameters(py, &rig.parameters)?)?;
    let suggestions = rig.suggestions.iter().map(|found| suggestion(py, found));
    entry.set_item("suggestions", suggestions.collect::<PyResult<Vec<_>>>()?)?;
    Ok(entry)
}

/// The status of each parameter, column by column.
fn parameters<'py>(py: Python<'py>, found: &[ParameterStatus]) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    let text = |of: &dyn Fn(&ParameterStatus) -> String| PyList::new(py, found.iter().map(of));
    let number = |of: &dyn Fn(&ParameterStatus) -> f64| {
        PyArray1::from_vec(py, found.iter().map(of).collect::<Vec<f64>>())
    };
    columns.set_item("name", text(&|one| one.name.clone())?)?;
    columns.set_item("unit", text(&|one| one.unit.clone())?)?;
    columns.set_item("plausible_size", number(&|one| one.plausible_size))?;
    columns.set_item("status", text(&|one| one.status.name().to_owned())?)?;
    let deviation = |one: &ParameterStatus| one.status.standard_deviation().unwrap_or(f64::NAN);
    columns.set_item("standard_deviation", number(&deviation))?;
    let reasons: Vec<_> = found.iter().map(|one| one.reason.as_deref()).collect();
    columns.set_item("reason", reasons)?;
    Ok(columns)
}

fn suggestion<'py>(py: Python<'py>, found: &Suggestion) -> PyResult<Bound<'py, PyDict>> {
    let entry = PyDict::new(py);
    entry.set_item("parameter", &found.parameter)?;
    entry.set_item("unit", &found.unit)?;
    entry.set_item("reason", &found.reason)?;
    entry.set_item("not_told_from", &found.not_told_from)?;
    let remedies = PyList::empty(py);
    for remedy in &found.remedies {
        let one = PyDict::new(py);
        one.set_item("measure", &remedy.measure)?;
        one.set_item("instead_of", &remedy.instead_of)?;
        one.set_item("standard_deviation", remedy.standard_deviation)?;
        remedies.append(one)?;
    }
    entry.set_item("remedies", remedies)?;
    Ok(entry)
}

fn next_poses<'py>(
    py: Python<'py>,
    joints: usize,
    criterion: &str,
    next: &NextPoses,
) -> PyResult<Bound<'py, PyDict>> {
    let entry = PyDict::new(py);
    entry.set_item("measure", &next.measure)?;
    entry.set_item("criterion", criterion)?;
    entry.set_item("count", next.count)?;
    entry.set_item("candidates", next.candidates)?;
    entry.set_item("figures", figures(py, &next.figures)?)?;
    let random = next.random.as_ref().map(|random| figures(py, random));
    entry.set_item("random", random.transpose()?)?;
    entry.set_item("exchanges", next.exchanges)?;
    let predicted = PyDict::new(py);
    let parameters = &next.parameters;
    let names: Vec<&str> = parameters.iter().map(|one| one.name.as_str()).collect();
    let units: Vec<&str> = parameters.iter().map(|one| one.unit.as_str()).collect();
    let sizes: Vec<f64> = parameters.iter().map(|one| one.plausible_size).collect();
    let deviations: Vec<f64> = parameters
        .iter()
        .map(|one| one.standard_deviation)
        .collect();
    predicted.set_item("name", names)?;
    predicted.set_item("unit", units)?;
    predicted.set_item("plausible_size", PyArray1::from_vec(py, sizes))?;
    predicted.set_item("standard_deviation", PyArray1::from_vec(py, deviations))?;
    entry.set_item("parameters", predicted)?;
    let postures = &next.postures;
    let reading = |(pose, joint): (usize, usize)| postures[pose].readings[joint];
    let readings = Array2::from_shape_fn((postures.len(), joints), reading);
    entry.set_item("readings", readings.to_pyarray(py))?;
    let touched = |of: fn(&Posture) -> &String| {
        let names: Vec<&str> = postures.iter().map(|pose| of(pose).as_str()).collect();
        names.iter().any(|name| !name.is_empty()).then_some(names)
    };
    entry.set_item("contact", touched(|posture| &posture.contact))?;
    entry.set_item("plane", touched(|posture| &posture.plane))?;
    Ok(entry)
}

fn figures<'py>(py: Python<'py>, figures: &Figures) -> PyResult<Bound<'py, PyDict>> {
    let entry = PyDict::new(py);
    entry.set_item("geometric_mean_sd", figures.geometric_mean_sd)?;
    entry.set_item("o1", figures.o1)?;
    entry.set_item("root_mean_square", figures.root_mean_square)?;
    Ok(entry)
}
