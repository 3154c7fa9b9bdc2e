//! The text of a device file from whatever was given: TOML, URDF or MJCF, the sensors of a rig file in it.

use std::path::Path;

use haptical_model::{Device as Model, read_toml_text};
use haptical_urdf::{UrdfDevice, UrdfError, device_from_mjcf, device_from_urdf, read_urdf_text};
use toml_edit::{DocumentMut, Item, value};

use super::{Equipment, InputDrumDenominators};
use crate::error::Error;
use crate::files::{InputFile, Source};

/// Text of a device file, what is odd about it, and the rig file that is in it.
pub(super) struct DeviceText {
    pub(super) text: String,
    pub(super) warnings: Vec<String>,
    pub(super) rig: Option<InputFile>,
}

/// Whether a file is a URDF, by its name.
pub fn is_urdf(path: &Path) -> bool {
    has_extension(path, "urdf")
}

/// Whether a file is an MJCF, MuJoCo's XML, by its name.
pub fn is_mjcf(path: &Path) -> bool {
    has_extension(path, "xml")
}

fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

/// Whether a file describes a robot in XML, in which a chain is chosen.
pub(crate) fn is_description(path: &Path) -> bool {
    is_urdf(path) || is_mjcf(path)
}

/// The chain of a robot's description; a file whose name ends in `.xml` is an MJCF.
///
/// # Errors
/// As [`device_from_urdf`] and [`device_from_mjcf`].
pub(crate) fn read_chain(
    text: &str,
    name: &str,
    path: &Path,
    equipment: &Equipment,
) -> Result<UrdfDevice, UrdfError> {
    match is_mjcf(path) {
        true => device_from_mjcf(text, name, equipment.ends()),
        false => device_from_urdf(text, name, equipment.ends()),
    }
}

/// The device file's text, the rig's sensors in it; that of a URDF or an MJCF is written anew.
pub(super) fn read(source: &Source, equipment: &Equipment) -> Result<DeviceText, Error> {
    let name = source.name();
    let refuse = |error: &_| Error::device_file(error, &source.path);
    let (mut text, mut warnings) = if is_description(&source.path) {
        read_description(source, equipment)?
    } else {
        let flags = [("--base", &equipment.base), ("--tip", &equipment.tip)];
        if let Some((flag, _)) = flags.iter().find(|(_, link)| link.is_some()) {
            return Err(Error::command_line(
                "arguments",
                format!("{flag} names a link of a URDF or an MJCF, and {name} is none"),
                format!("leave {flag} out, or give a .urdf or .xml file"),
            ));
        }
        (read_toml(source)?, Vec::new())
    };
    let mut file = None;
    if let Some(rig) = &equipment.rig {
        let rig_text = read_toml(rig)?;
        // its own faults first, at its own places
        Model::from_toml(&text, &name).map_err(|error| refuse(&error))?;
        let merged = Model::with_rig(&text, &name, &rig_text, &rig.name());
        let (merged, odd) = merged.map_err(|error| Error::device_file(&error, &rig.path))?;
        text = merged;
        warnings.extend(odd);
        rig.relabel(&mut warnings);
        file = Some(rig.input("rig", rig.fingerprint_text(&rig_text)));
    }
    Ok(DeviceText {
        text,
        warnings,
        rig: file,
    })
}

fn read_toml(source: &Source) -> Result<String, Error> {
    let refuse = |error| Error::device_file(&error, &source.path);
    let text = source.text.clone().map(Ok);
    text.unwrap_or_else(|| read_toml_text(&source.path).map_err(refuse))
}

fn read_description(
    source: &Source,
    equipment: &Equipment,
) -> Result<(String, Vec<String>), Error> {
    let refuse = |error| Error::urdf(&error, &source.path);
    let text = match &source.text {
        Some(text) => text.clone(),
        None => read_urdf_text(&source.path).map_err(refuse)?,
    };
    let read = read_chain(&text, &source.name(), &source.path, equipment).map_err(refuse)?;
    let text = read.device.to_new_toml();
    let text = text.map_err(|error| Error::device_file(&error, &source.path))?;
    Ok((text, read.warnings))
}

/// The device text with the denominators in it, so that identified.toml means the same device.
pub(super) fn with_denominators(
    text: &str,
    device: &Model,
    denominators: InputDrumDenominators,
    name: &str,
) -> Result<String, Error> {
    let mut document: DocumentMut = text.parse().map_err(Error::internal)?;
    let rows = document
        .get_mut("joint")
        .and_then(Item::as_array_of_tables_mut)
        .ok_or_else(|| {
            Error::bad_input(
                "not-supported",
                "input drum denominators can only be put into [[joint]] tables",
                name,
                "write each joint as a [[joint]] table, or give input_drum_denominator_m there",
            )
        })?;
    for (index, (row, joint)) in rows.iter_mut().zip(&device.joints).enumerate() {
        if let Some(length_m) = denominators.for_joint(index)
            && joint.drum_distance_m.is_some()
        {
            row.insert("input_drum_denominator_m", value(length_m));
        }
    }
    Ok(document.to_string())
}
