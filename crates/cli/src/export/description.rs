//! Robot descriptions of a device: a corrected URDF, a new one, or an MJCF.

use haptical::files::Source;
use haptical::{Equipment, is_urdf};
use haptical_model::Device;
use haptical_urdf::{corrected_urdf, new_mjcf, new_urdf, read_urdf_text};

use super::{ExportArguments, FormatName};
use crate::failure::Failure;

/// Reads the device. `--base` and `--tip` are about whichever URDF is given.
pub(super) fn read(arguments: &ExportArguments) -> Result<haptical::Device, Failure> {
    if arguments.urdf.is_some() && !matches!(arguments.format, FormatName::Urdf) {
        return Err(Failure::command_line(
            "arguments",
            "--urdf is for --format urdf alone",
            "leave --urdf out, or write --format urdf",
        ));
    }
    let options = &arguments.device_options;
    if arguments.urdf.is_none() || is_urdf(&arguments.device) {
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
    let refuse = |error: haptical_urdf::UrdfError| Failure::urdf(&error, path);
    match (&arguments.format, &arguments.urdf) {
        (FormatName::Mjcf, _) => new_mjcf(device).map_err(refuse),
        (_, None) => new_urdf(device).map_err(refuse),
        (_, Some(original)) => {
            let refuse = |error: haptical_urdf::UrdfError| Failure::urdf(&error, original);
            let text = read_urdf_text(original).map_err(refuse)?;
            let equipment = arguments.device_options.equipment();
            let name = original.display().to_string();
            let corrected =
                corrected_urdf(&text, &name, equipment.ends(), device).map_err(refuse)?;
            Ok((corrected.text, corrected.warnings))
        }
    }
}
