//! Identification of a moving arm's dynamics: a device and a log of torques in, the device with other masses and friction out.

mod page;
mod result;
mod text;

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use haptical_effects::device::attached;
use haptical_model::{Device as Model, Recording};
use haptical_motion::{Dynamics, MotionError, NOISE_SEED, with_dynamics};

pub use self::result::{
    BodyEntry, CombinationEntry, IdentifiedDynamics, JointEntry, NumberEntry, StackedEntry,
    TorqueEntry,
};
use crate::device::Device;
use crate::error::Error;
use crate::files::{
    IDENTIFICATION_FILES, NewFile, Record, ResultKind, Source, VERSION, sealed_json,
    without_comments,
};
use crate::log::Log;

/// The word of `--with` that asks for it.
pub const DYNAMICS: &str = "dynamics";

/// What a result says of its inputs.
struct IdentifiedHead {
    device: String,
    log: String,
    validate: Option<String>,
    rows: usize,
}

/// A device with identified dynamics. It prints as the table of the command.
#[derive(Debug)]
pub struct FoundDynamics {
    /// The device.
    pub device: Device,
    /// Everything that was found.
    pub dynamics: Dynamics,
    /// The content of identified.json.
    pub result: IdentifiedDynamics,
}

/// Identifies the dynamics of a device from a log of its positions and torques: inertias, friction, armatures, offsets, one delay.
///
/// `validate` is a log that is predicted and not fitted; `band_hz` the edge of the low pass, where it is not for the log to say.
///
/// ```no_run
/// use haptical::{Device, Log, identify_dynamics};
/// let device = Device::load("arm.urdf")?;
/// let log = Log::read("motion.csv", &device)?;
/// let found = identify_dynamics(&device, &log, None, None)?;
/// println!("{found}");
/// # Ok::<(), haptical::Error>(())
/// ```
///
/// # Errors
/// A log without times or torques, too slow, too short or of a standstill; a device without rows.
pub fn identify_dynamics(
    device: &Device,
    log: &Log,
    validate: Option<&Log>,
    band_hz: Option<f64>,
) -> Result<FoundDynamics, Error> {
    identify_dynamics_as(VERSION, device, log, validate, band_hz)
}

/// The same under the name of another version, for a result that is made again.
///
/// # Errors
/// As [`identify_dynamics`].
pub fn identify_dynamics_as(
    version: &str,
    device: &Device,
    log: &Log,
    validate: Option<&Log>,
    band_hz: Option<f64>,
) -> Result<FoundDynamics, Error> {
    let bare = without_friction(&device.model);
    let place = (device.source().path.as_path(), log.source().path.as_path());
    let recording = without_effects(&bare, &log.recording, place)?;
    let second = validate.map(|own| without_effects(&bare, &own.recording, place));
    let second = second.transpose()?;
    let found = haptical_motion::identify_dynamics(&bare, &recording, second.as_deref(), band_hz);
    let dynamics = found.map_err(|error| refused(&error, place.1))?;
    let model = with_dynamics(&bare, &dynamics)
        .map_err(|error| Error::internal(format!("{}: {error}", place.0.display())))?;
    let mut inputs = device.inputs("device");
    inputs.splice(1..1, log.input("log"));
    inputs.extend(validate.and_then(|own| own.input("validate")));
    let mut flags = vec![format!("--with={DYNAMICS}")];
    flags.extend(band_hz.map(|edge| format!("--band-hz={edge}")));
    flags.extend(device.equipment().chain_flags());
    let mut record = Record::of(version, "identify", inputs, flags);
    record.seeds.insert("noise added to positions", NOISE_SEED);
    let mut warnings = device.warnings.clone();
    warnings.extend_from_slice(&log.warnings);
    warnings.extend(validate.iter().flat_map(|own| own.warnings.clone()));
    let head = IdentifiedHead {
        device: device.source().label.clone(),
        log: log.source().label.clone(),
        validate: validate.map(|own| own.source().label.clone()),
        rows: log.recording.len(),
    };
    let result = IdentifiedDynamics::new(&device.model, &dynamics, head, warnings, record);
    let toml = model
        .to_toml(without_comments(device.to_toml()), &device.source().label)
        .map_err(|error| Error::device_file(&error, place.0))?;
    let text = result.provenance.toml_comments()? + &toml;
    let source = Source::text(text, IDENTIFICATION_FILES[0]);
    Ok(FoundDynamics {
        device: Device::open(&source, &crate::Equipment::default())?,
        dynamics,
        result,
    })
}

impl FoundDynamics {
    /// What is odd about the device, the logs and the result.
    pub fn warnings(&self) -> &[String] {
        &self.result.warnings
    }

    /// The files, as they are written.
    ///
    /// # Errors
    /// A fault of this library alone.
    pub fn files(&self) -> Result<Vec<NewFile<'static>>, Error> {
        let [toml_name, json_name, page_name, _] = IDENTIFICATION_FILES;
        let page = page::page(&self.result)?;
        let mut files = vec![
            (toml_name, self.device.to_toml().as_bytes().to_vec()),
            (page_name, page.into_bytes()),
        ];
        let mut result = self.result.clone();
        result.provenance = result.provenance.with_outputs(&files);
        files.insert(1, (json_name, sealed_json(&result)?.into_bytes()));
        Ok(files)
    }

    /// Writes identified.toml, identified.json, identify.html and report.html: all of them or none.
    ///
    /// # Errors
    /// As [`crate::identify::Found::write`].
    pub fn write(&self, folder: impl AsRef<Path>) -> Result<Vec<PathBuf>, Error> {
        ResultKind::IDENTIFICATION.write(folder.as_ref(), &self.files()?)
    }
}

impl std::fmt::Display for FoundDynamics {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        text::write(formatter, &self.result)
    }
}

/// A device without the friction that is found anew.
pub(crate) fn without_friction(model: &Model) -> Model {
    let mut bare = model.clone();
    bare.effects.retain(|own| !own.is_friction());
    bare
}

/// A recording whose torques lack what the device's own effects add to them.
pub(crate) fn without_effects<'r>(
    model: &Model,
    recording: &'r Recording,
    (device, log): (&Path, &Path),
) -> Result<Cow<'r, Recording>, Error> {
    let with = attached(&mut model.clone(), recording);
    let mut with = with.map_err(|error| Error::effect(&error, device, log))?;
    if with.added.is_empty() {
        return Ok(with);
    }
    let own = with.to_mut();
    for added in std::mem::take(&mut own.added) {
        let joints = model.joints.iter().enumerate();
        let joints = joints.zip(&mut own.torque_nm);
        let of_torque =
            joints.filter(|((joint, of), _)| of.torque_column(joint + 1) == added.channel);
        let first = of_torque.take(1).filter_map(|(_, torque)| torque.as_mut());
        for torque in first {
            for (value, added) in torque.iter_mut().zip(&added.readings) {
                *value -= added;
            }
        }
    }
    Ok(with)
}

/// Why a log says nothing of dynamics, and what to do.
fn refused(error: &MotionError, log: &Path) -> Error {
    let next = match error {
        MotionError::Missing { .. } => {
            "give a log with time (t_s), the position of every joint and their torques (torque1_nm, ...; torque1_n of a slide)"
        }
        MotionError::Standstill => {
            "record a motion that reverses every joint, at the speeds that the model is for"
        }
        MotionError::Sampling(_) => {
            "record positions and torques of one motion at 100 rows a second or more, without gaps"
        }
        MotionError::Model(_) => {
            "give a device with [[link]] rows for every joint, or its URDF or MJCF"
        }
        _ => "record a longer motion that moves every joint",
    };
    Error::in_file("dynamics", error.to_string(), log, next)
}
