//! Robot descriptions of a device: a corrected URDF or MJCF, or a new one, and what programs make of them; ROS 2's formats.

use std::path::Path;

use haptical_model::Device;
use haptical_urdf::{
    NewJoints, UrdfError, corrected_mjcf, corrected_urdf, kinematics_yaml, loader_notes, new_mjcf,
    new_urdf, new_urdf_for, read_urdf_text, ros2_control,
};

use super::{Export, Form};
use crate::error::Error as Failure;

/// The text, and what it leaves out, or what the program that reads it makes of it; `sha256` is the device file's.
pub(super) fn text(
    (device, path): (&Device, &Path),
    request: &Export<'_>,
    sha256: &str,
) -> Result<(String, Vec<String>), Failure> {
    if request.form == Form::Ros2Control {
        return Ok(ros2_control(device));
    }
    let (text, mut warnings) = written((device, path), request, sha256)?;
    if let Some(loader) = request.loader {
        let notes = loader_notes(&text, "the URDF that is written", loader);
        warnings.extend(notes.map_err(Failure::internal)?);
    }
    Ok((text, warnings))
}

fn written(
    (device, path): (&Device, &Path),
    request: &Export<'_>,
    sha256: &str,
) -> Result<(String, Vec<String>), Failure> {
    let refuse = |error: UrdfError| Failure::urdf(&error, path);
    let given = match request.form {
        Form::Mjcf => request.mjcf,
        _ => request.urdf,
    };
    let Some(original) = given else {
        return match (request.form, request.loader) {
            (Form::Mjcf, _) => new_mjcf(device).map_err(refuse),
            (_, Some(loader)) => new_urdf_for(device, loader).map_err(refuse),
            (_, None) => new_urdf(device).map_err(refuse),
        };
    };
    let refuse = |error: UrdfError| Failure::urdf(&error, original);
    let text = read_urdf_text(original).map_err(refuse)?;
    let (name, ends) = (original.display().to_string(), request.ends);
    match request.form {
        Form::Mjcf => {
            let new_joints = match request.new_joints {
                true => NewJoints::PutIn,
                false => NewJoints::Listed,
            };
            let corrected = corrected_mjcf(&text, &name, ends, device, new_joints);
            let corrected = corrected.map_err(refuse)?;
            Ok((corrected.text, corrected.warnings))
        }
        Form::KinematicsYaml => {
            let hash = format!("haptical_{}", sha256.get(..16).unwrap_or(sha256));
            kinematics_yaml(&text, &name, ends, device, &hash).map_err(refuse)
        }
        _ => {
            let corrected = corrected_urdf(&text, &name, ends, device).map_err(refuse)?;
            Ok((corrected.text, corrected.warnings))
        }
    }
}

/// Refuses what does not belong to a form.
pub(super) fn check(request: &Export<'_>) -> Result<(), Failure> {
    let refuse = |what: &str, next: &str| Err(Failure::command_line("arguments", what, next));
    let takes_urdf = matches!(request.form, Form::Urdf | Form::KinematicsYaml);
    if request.urdf.is_some() && !takes_urdf {
        let what = "--urdf is for --format urdf and kinematics-yaml alone";
        return refuse(what, "leave --urdf out, or write --format urdf");
    }
    if request.urdf.is_none() && request.form == Form::KinematicsYaml {
        return refuse(
            "--format kinematics-yaml is of the URDF that the device came from, and --urdf names none",
            "give --urdf, or write --format urdf for a new one",
        );
    }
    if request.loader.is_some() && request.form != Form::Urdf {
        let next = "leave --for out, or write --format urdf";
        return refuse("--for is for --format urdf alone", next);
    }
    if request.mjcf.is_some() && request.form != Form::Mjcf {
        let next = "leave --mjcf out, or write --format mjcf";
        return refuse("--mjcf is for --format mjcf alone", next);
    }
    Ok(())
}
