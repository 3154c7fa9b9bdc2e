//! Robot descriptions of a device: a corrected URDF or MJCF, or a new one.

use haptical::files::Source;
use haptical::{Equipment, is_mjcf, is_urdf};
use haptical_model::Device;
use haptical_urdf::{
    NewJoints, UrdfError, corrected_mjcf, corrected_urdf, new_mjcf, new_urdf, read_urdf_text,
};

use super::{ExportArguments, FormatName};
use crate::failure::Failure;

/// Reads the device. `--base` and `--tip` are about whichever URDF or MJCF is given.
pub(super) fn read(arguments: &ExportArguments) -> Result<haptical::Device, Failure> {
    if arguments.urdf.is_some() && !matches!(arguments.format, FormatName::Urdf) {
        return Err(Failure::command_line(
            "arguments",
            "--urdf is for --format urdf alone",
            "leave --urdf out, or write --format urdf",
        ));
    }
    if arguments.mjcf.is_some() && !matches!(arguments.format, FormatName::Mjcf) {
        return Err(Failure::command_line(
            "arguments",
            "--mjcf is for --format mjcf alone",
            "leave --mjcf out, or write --format mjcf",
        ));
    }
    let options = &arguments.device_options;
    let is_new = arguments.urdf.is_none() && arguments.mjcf.is_none();
    if is_new || is_urdf(&arguments.device) || is_mjcf(&arguments.device) {
        return options.read_by_path(&arguments.device);
    }
    let equipment = Equipment {
        rig: options.rig.as_deref().map(Source::by_path),
        ..Equipment::default()
    };
    haptical::Device::open(&Source::by_path(&arguments.device), &equipment)
}

/// The text, and what it leaves out.
pub(super) fn text(
    arguments: &ExportArguments,
    device: &Device,
) -> Result<(String, Vec<String>), Failure> {
    let path = &arguments.device;
    let refuse = |error: UrdfError| Failure::urdf(&error, path);
    let given = match arguments.format {
        FormatName::Mjcf => &arguments.mjcf,
        _ => &arguments.urdf,
    };
    let Some(original) = given else {
        return match arguments.format {
            FormatName::Mjcf => new_mjcf(device).map_err(refuse),
            _ => new_urdf(device).map_err(refuse),
        };
    };
    let refuse = |error: UrdfError| Failure::urdf(&error, original);
    let text = read_urdf_text(original).map_err(refuse)?;
    let equipment = arguments.device_options.equipment();
    let (name, ends) = (original.display().to_string(), equipment.ends());
    match arguments.format {
        FormatName::Mjcf => {
            let new_joints = match arguments.new_joints {
                true => NewJoints::PutIn,
                false => NewJoints::Listed,
            };
            let corrected = corrected_mjcf(&text, &name, ends, device, new_joints);
            let corrected = corrected.map_err(refuse)?;
            Ok((corrected.text, corrected.warnings))
        }
        _ => {
            let corrected = corrected_urdf(&text, &name, ends, device).map_err(refuse)?;
            Ok((corrected.text, corrected.warnings))
        }
    }
}
