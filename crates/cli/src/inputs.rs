//! Reads the device file and the log that a command was given.

use std::fs::File;
use std::path::Path;

use haptical_calibration::check_reach;
use haptical_data::{LogShape, read_log, read_log_from};
use haptical_model::{Device, Recording};
use haptical_urdf::BaseAndTip;
use toml_edit::{DocumentMut, Item, value};

use crate::device_source::{DeviceText, read_device_text};
use crate::failure::Failure;
use crate::input_files::{Fingerprint, HashingReader};

/// A device with the text it came from.
pub(crate) struct DeviceInput {
    pub(crate) device: Device,
    /// Text of the file, overrides applied: identified.toml is written from it.
    pub(crate) text: String,
    pub(crate) warnings: Vec<String>,
}

/// Input drum denominators that replace the device file's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum InputDrumDenominators {
    /// The file's.
    Stated,
    /// One for all joints with drums.
    Same(f64),
    /// 2.9 mm, joint 4: 2.6 mm, as the paper's tables imply.
    Paper,
}

impl InputDrumDenominators {
    fn of_joint(self, joint: usize) -> Option<f64> {
        match (self, joint) {
            (Self::Stated, _) => None,
            (Self::Same(length_m), _) => Some(length_m),
            (Self::Paper, 3) => Some(2.6e-3),
            (Self::Paper, _) => Some(2.9e-3),
        }
    }
}

/// Reads a device file, TOML or URDF.
pub(crate) fn read_device(
    path: &Path,
    denominators: InputDrumDenominators,
) -> Result<DeviceInput, Failure> {
    read_equipped_device(path, BaseAndTip::default(), None, denominators)
}

/// Reads a device file; `ends` are links of a URDF between which the chain runs, `rig` a file with sensors
/// that take the place of the device file's.
pub(crate) fn read_equipped_device(
    path: &Path,
    ends: BaseAndTip<'_>,
    rig: Option<&Path>,
    denominators: InputDrumDenominators,
) -> Result<DeviceInput, Failure> {
    let name = path.display().to_string();
    let refuse = |error: &_| Failure::device_file(error, path);
    let DeviceText { text, mut warnings } = read_device_text(path, ends, rig)?;
    let mut loaded = Device::from_toml(&text, &name).map_err(|error| refuse(&error))?;
    warnings.append(&mut loaded.warnings);
    let (device, text) = if denominators == InputDrumDenominators::Stated {
        (loaded.device, text)
    } else {
        let text = with_denominators(&text, &loaded.device, denominators, &name)?;
        let changed = Device::from_toml(&text, &name).map_err(|error| refuse(&error))?;
        (changed.device, text)
    };
    Ok(DeviceInput {
        device,
        text,
        warnings,
    })
}

/// The device text with the denominators in it, so that identified.toml means the same device.
fn with_denominators(
    text: &str,
    device: &Device,
    denominators: InputDrumDenominators,
    name: &str,
) -> Result<String, Failure> {
    let mut document: DocumentMut = text.parse().map_err(Failure::internal)?;
    let rows = document
        .get_mut("joint")
        .and_then(Item::as_array_of_tables_mut)
        .ok_or_else(|| {
            Failure::bad_input(
                "not-supported",
                "input drum denominators can only be put into [[joint]] tables",
                name,
                "write each joint as a [[joint]] table, or give input_drum_denominator_m there",
            )
        })?;
    for (index, (row, joint)) in rows.iter_mut().zip(&device.joints).enumerate() {
        if let Some(length_m) = denominators.of_joint(index)
            && joint.drum_distance_m.is_some()
        {
            row.insert("input_drum_denominator_m", value(length_m));
        }
    }
    Ok(document.to_string())
}

/// A log that was read.
pub(crate) struct LogInput {
    pub(crate) recording: Recording,
    /// What is odd about it.
    pub(crate) warnings: Vec<String>,
    pub(crate) fingerprint: Fingerprint,
}

/// Reads a log of a device, once: it may be a pipe.
pub(crate) fn read_recording(path: &Path, device: &Device) -> Result<LogInput, Failure> {
    let shape = LogShape::from(device);
    let name = path.display().to_string();
    let file = match File::open(path) {
        Ok(file) => file,
        Err(error) => {
            let said = read_log(path, &shape).err();
            return Err(said.map_or_else(|| Failure::internal(error), Failure::from));
        }
    };
    let mut reader = HashingReader::new(file);
    let log =
        read_log_from(&mut reader, &name, &shape).map_err(|error| Failure::log(error, device))?;
    // The log was read without error, but its end may not have been asked for.
    let _ = std::io::copy(&mut reader, &mut std::io::sink());
    let fingerprint = reader.fingerprint();
    check_reach(device, &log.recording)
        .map_err(|error| Failure::calibration(&error, path, path))?;
    Ok(LogInput {
        recording: log.recording,
        warnings: log.warnings,
        fingerprint,
    })
}

/// The model must be of the same device: the same joints, in the same order, on as many links.
pub(crate) fn refuse_other_device(
    nominal: &Device,
    model: &Device,
    path: &Path,
) -> Result<(), Failure> {
    let types = |device: &Device| -> Vec<_> {
        device.joints.iter().map(|joint| joint.joint_type).collect()
    };
    let what = if nominal.joints.len() != model.joints.len() {
        let (wanted, got) = (nominal.joints.len(), model.joints.len());
        format!("the model has {got} joints, the device has {wanted}")
    } else if nominal.links.len() != model.links.len() {
        let (wanted, got) = (nominal.links.len(), model.links.len());
        format!("the model has {got} links, the device has {wanted}")
    } else if nominal.convention != model.convention {
        "the model has another convention of its links than the device".to_owned()
    } else if let Some(joint) =
        (0..nominal.joints.len()).find(|&joint| types(nominal)[joint] != types(model)[joint])
    {
        format!(
            "joint {} turns in one of model and device and slides in the other",
            joint + 1
        )
    } else {
        return Ok(());
    };
    Err(Failure::bad_input(
        "other-device",
        what,
        path.display().to_string(),
        "give the identified.toml of this device",
    ))
}
