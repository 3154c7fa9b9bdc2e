//! Robot descriptions of a device: a corrected URDF, a new one, or an MJCF.

use haptical_model::Device;
use haptical_urdf::{BaseAndTip, corrected_urdf, new_mjcf, new_urdf, read_urdf_text};

use super::{ExportArguments, FormatName};
use crate::device_source::is_urdf;
use crate::failure::Failure;
use crate::inputs::{DeviceInput, InputDrumDenominators, read_equipped_device};

/// Reads the device. `--base` and `--tip` are about whichever URDF is given.
pub(super) fn read(arguments: &ExportArguments) -> Result<DeviceInput, Failure> {
    if arguments.urdf.is_some() && !matches!(arguments.format, FormatName::Urdf) {
        return Err(Failure::command_line(
            "arguments",
            "--urdf is for --format urdf alone",
            "leave --urdf out, or write --format urdf",
        ));
    }
    let options = &arguments.device_options;
    let of_device = match arguments.urdf.is_none() || is_urdf(&arguments.device) {
        true => options.chain.ends(),
        false => BaseAndTip::default(),
    };
    read_equipped_device(
        &arguments.device,
        of_device,
        options.rig.as_deref(),
        InputDrumDenominators::Stated,
    )
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
            let ends = arguments.device_options.chain.ends();
            let name = original.display().to_string();
            let corrected = corrected_urdf(&text, &name, ends, device).map_err(refuse)?;
            Ok((corrected.text, corrected.warnings))
        }
    }
}
