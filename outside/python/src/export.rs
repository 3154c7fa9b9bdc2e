//! `haptical.export`: a device as a text for a control loop, a simulator, a planner or ROS 2.

use std::path::PathBuf;

use haptical::urdf::Loader;
use haptical::{Export, Form, export as export_device};
use pyo3::prelude::*;

use crate::device::{Tips, device_of};
use crate::failure::Failure;
use crate::options::unknown;

/// The text, and what it leaves out.
#[pyfunction]
#[pyo3(signature = (device, format, *, urdf=None, mjcf=None, new_joints=false, for_=None, base=None, tip=None, rig=None))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub(crate) fn export(
    device: &Bound<'_, PyAny>,
    format: &str,
    urdf: Option<PathBuf>,
    mjcf: Option<PathBuf>,
    new_joints: bool,
    for_: Option<&str>,
    base: Option<&str>,
    tip: Option<Tips>,
    rig: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, Vec<String>)> {
    let form = match format {
        "rust" => Form::Rust,
        "c-header" => Form::CHeader,
        "json" => Form::Json,
        "toml" => Form::Toml,
        "urdf" => Form::Urdf,
        "mjcf" => Form::Mjcf,
        "ros2-control" => Form::Ros2Control,
        "kinematics-yaml" => Form::KinematicsYaml,
        other => {
            let known = "rust, c-header, json, toml, urdf, mjcf, ros2-control, kinematics-yaml";
            return Err(unknown("format", other, known).into());
        }
    };
    let loader = match for_ {
        None => None,
        Some("pinocchio") => Some(Loader::Pinocchio),
        Some("drake") => Some(Loader::Drake),
        Some("isaac") => Some(Loader::Isaac),
        Some("moveit") => Some(Loader::Moveit),
        Some(other) => return Err(unknown("for_", other, "pinocchio, drake, isaac, moveit").into()),
    };
    // of a file that is corrected base and tip say where its chain ran
    let is_corrected = urdf.is_some() || mjcf.is_some();
    let (ends, tips) = match is_corrected {
        true => ((None, None), tip.map(Tips::all).unwrap_or_default()),
        false => ((base, tip), Vec::new()),
    };
    let device = device_of(device, ends, rig)?;
    let request = Export {
        urdf: urdf.as_deref(),
        mjcf: mjcf.as_deref(),
        ends: haptical::urdf::BaseAndTip {
            base: base.filter(|_| is_corrected),
            tip: tips.first().map(String::as_str),
            further_tips: tips.get(1..).unwrap_or_default(),
        },
        new_joints,
        loader,
        ..Export::new(form)
    };
    let exported = export_device(&device.read, &request).map_err(Failure::from)?;
    Ok((exported.text, exported.warnings))
}
