//! Identification: a device and a log in; values, intervals, reasons, files and the table of residuals out.

mod dynamics;
mod effects;
pub(crate) mod intervals;
mod moved;
mod page;
pub(crate) mod refused;
mod result;
mod summary;
mod transmissions;
mod with;

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use haptical_calibration::{
    Calibration, CalibrationError, ChannelReport, Degree, ForceDirection, HeldOut, LossChoice,
    Options, Weighting, force_direction, without_copies,
};
use haptical_effects::{Ahead, OtherClock};
use haptical_model::{Device as Model, DeviceEffect, ParameterId, Recording, TransmissionKind};

pub use self::dynamics::{
    BodyEntry, CombinationEntry, DYNAMICS, FoundDynamics, IdentifiedDynamics, JointEntry,
    NumberEntry, StackedEntry, TorqueEntry, identify_dynamics, identify_dynamics_as,
};
pub(crate) use self::dynamics::{without_effects, without_friction};
pub use self::effects::{EffectEntry, EffectNumber};
use self::effects::{calibrate_with_effects, held};
pub use self::moved::MovedEntry;
use self::result::identified;
pub use self::result::{
    IdentifiabilityEntry, Identified, LossEntry, NoiseEntry, NotIdentified, ParameterEntry,
    RankEntry, RejectedEntry,
};
pub use self::transmissions::TransmissionEntry;
use crate::device::{Device, InputDrumDenominators};
use crate::error::Error;
use crate::files::{
    IDENTIFICATION_FILES, InputFile, NewFile, Record, ResultKind, Source, Thresholds, VERSION,
    sealed_json, without_comments,
};
use crate::log::Log;
use crate::reproduced::{Left, comments, reproduced};

/// What an identification is asked for; the default is what `haptical identify` does without flags.
#[derive(Debug, Clone, PartialEq)]
pub struct Identify {
    /// Method, weights, loss, held-out rows.
    pub options: Options,
    /// Effects to fit with geometry and drives: `EFFECT` or `EFFECT@JOINT`, each a law of the catalogue.
    pub with: Vec<String>,
    /// A gap.json whose causes are fitted too.
    pub with_causes: Option<Source>,
    /// Numbers of the links that are kept: `lengths`, `twists`, `offsets`, `a`, `theta`, ..., or one row's, `a3`.
    pub hold: Vec<String>,
    /// How far such numbers may plausibly be off \[m\] or \[rad\].
    pub deviations: Vec<(String, f64)>,
}

impl Default for Identify {
    fn default() -> Self {
        Self {
            options: Options {
                loss: LossChoice::Auto,
                held_out: HeldOut::Share(0.2),
                ..Options::default()
            },
            with: Vec::new(),
            with_causes: None,
            hold: Vec::new(),
            deviations: Vec::new(),
        }
    }
}

/// An identified device, with all that is known of how well. It prints as the table of the command.
#[derive(Debug)]
pub struct Found {
    /// The identified device.
    pub device: Device,
    /// The calibration in full, residuals of every row included.
    pub calibration: Calibration,
    /// The content of identified.json.
    pub result: Identified,
    recording: Arc<Recording>,
    toml: String,
    /// Whether the device file, replayed on the log, leaves what the fit leaves: else it is not written.
    is_reproduced: bool,
    /// The text of rejected.toml.
    rejected: Option<String>,
}

/// Identifies the parameters of a device from a log.
///
/// # Errors
/// [`ErrorKind::Unidentifiable`](crate::ErrorKind) where the log fixes nothing, otherwise what is wrong with a
/// reading, the device or an option, and where; [`ErrorKind::Interrupted`](crate::ErrorKind) after a request of
/// `options.options.search.interrupt`.
pub fn identify(device: &Device, log: &Log, options: &Identify) -> Result<Found, Error> {
    identify_as(VERSION, device, log, options)
}

/// The same under the name of another version, for a result that is made again.
///
/// # Errors
/// As [`identify`].
pub fn identify_as(
    version: &str,
    device: &Device,
    log: &Log,
    options: &Identify,
) -> Result<Found, Error> {
    let (recording, copies) = without_copies(&log.recording);
    let mut model = device.model.clone();
    let causes = options.apply(&mut model)?;
    let (device_path, log_path) = (&device.source().path, &log.source().path);
    let refuse = |error: CalibrationError| {
        Error::calibration(&error, device_path, log_path).with_equipment(device)
    };
    let found = calibrate_with_effects(&model, &recording, &options.options);
    Error::unless_interrupted(&options.options.search.interrupt, log_path)?;
    let (calibration, mut effects) = found
        .map_err(|error| Error::diagnosis(&error, device_path, log_path).with_equipment(device))?;
    refuse_overflow(&calibration, &recording, log_path)?;
    let warnings = [&device.warnings, &log.warnings, &calibration.warnings];
    let mut warnings = warnings.map(Clone::clone);
    warnings[1].extend(copies);
    warnings[2].extend(ahead(&calibration.device, &recording));
    let mut inputs = device.inputs("device");
    // behind the device, before the rig: the order of the flags
    inputs.splice(1..1, log.input("log"));
    inputs.extend(causes);
    let mut record = Record::of(version, "identify", inputs, options.flags(device));
    record.thresholds = Some(Thresholds::from_options(&options.options));
    let force = force(&model, &calibration, &recording).map_err(refuse)?;
    let labels = [device.source(), log.source()].map(|source| source.label.as_str());
    let fit = (
        Calibration::method_name(options.options.method),
        recording.len(),
    );
    let mut result = identified(&calibration, labels, fit, force, warnings.concat(), record);
    result.moved = moved::moved(device, &calibration, &result.parameters);
    result.named_rows = device.named_rows();
    effects.extend(held(&device.model, &model));
    result.tell_effects(effects);
    let written = |model: &Model| {
        let text = model.to_toml(without_comments(device.to_toml()), &device.source().label);
        text.map_err(|error| Error::device_file(&error, device_path))
    };
    let toml = written(&calibration.device)?;
    let rejected = match &calibration.rejected {
        Some(rejected) => {
            let comments = result.provenance.toml_comments()?;
            let why = "# Rejected: worse than the given device on rows that the fit did not see; identified.json says how.\n";
            Some(comments + why + &written(&rejected.device)?)
        }
        None => None,
    };
    let fitted = match recording {
        Cow::Borrowed(_) => Cow::Borrowed(log),
        Cow::Owned(own) => Cow::Owned(log.with_recording(own)),
    };
    let has = |channel: &str, row: usize| {
        let mut reports = calibration.fit_channels.iter();
        let report = reports.find(|report| report.channel == channel);
        report.is_some_and(|report| report.rows.binary_search(&row).is_ok())
    };
    let mut left = left(&calibration);
    let reproduced = reproduced(&toml, Found::FILES[0], &fitted, &left, &has);
    let is_reproduced = reproduced.is_ok();
    match reproduced {
        Ok(whole) => {
            for (name, rms) in whole {
                result.tell_fit(&name, rms);
                let own = left.iter_mut().find(|own| own.channel == name);
                own.into_iter().for_each(|own| own.rms = rms);
            }
        }
        Err(why) => {
            let warning = format!("{} is not written: {why}", Found::FILES[0]);
            result.warnings.insert(0, warning);
        }
    }
    let comments = result.provenance.toml_comments()? + &comments(&left, &[]);
    let source = Source::text(comments + &toml, Found::FILES[0]);
    Ok(Found {
        device: Device::open(&source, &crate::Equipment::default())?,
        calibration,
        result,
        recording: Arc::clone(&fitted.recording),
        toml,
        is_reproduced,
        rejected,
    })
}

/// What the fit leaves of each channel on its own rows, beside the rows that it did not see.
fn left(calibration: &Calibration) -> Vec<Left> {
    let of_channel = |report: &ChannelReport| {
        let mut held_out = calibration.held_out_channels.iter();
        let held_out = held_out.find(|own| own.channel == report.channel);
        Left {
            channel: report.channel.clone(),
            unit: report.unit.clone(),
            rms: report.rms_after,
            held_out: held_out.map(|own| own.rms_after),
            noise_floor: report.noise_floor,
        }
    };
    calibration.fit_channels.iter().map(of_channel).collect()
}

/// How far the force at the handle may lean; none for an arm without drives, which renders no force there.
fn force(
    model: &Model,
    calibration: &Calibration,
    recording: &Recording,
) -> Result<Option<ForceDirection>, CalibrationError> {
    let mut drives = model.joints.iter().map(|joint| joint.transmission);
    match &calibration.fitted.whole {
        // a fit of drives and their effects alone has no handle
        Some(whole)
            if drives.any(|drive| drive != TransmissionKind::Direct)
                && (whole.parameters.iter()).any(|id| matches!(id, ParameterId::Link { .. })) =>
        {
            force_direction(whole, recording)
        }
        _ => Ok(None),
    }
}

impl Identify {
    /// Adds what is to be fitted; the file that says it, where it is one.
    fn apply(&self, model: &mut Model) -> Result<Option<InputFile>, Error> {
        for word in &self.with {
            with::add(model, word)?;
        }
        let mut causes = None;
        if let Some(source) = &self.with_causes {
            let text = source.read_text()?;
            with::add_causes(model, &text, &source.name())?;
            causes = Some(source.input("with", source.fingerprint_text(&text)));
        }
        self.hold(model)?;
        Ok(causes)
    }

    /// Keeps the numbers that are held, and notes how far others may be off.
    ///
    /// # Errors
    /// A word that names no numbers of a link.
    pub fn hold(&self, model: &mut Model) -> Result<(), Error> {
        hold(model, &self.hold, &self.deviations)
    }

    /// The flags of the command that decide the result, defaults included.
    fn flags(&self, device: &Device) -> Vec<String> {
        let options = &self.options;
        let mut flags = vec![
            format!("--method={}", Calibration::method_name(options.method)),
            match options.held_out {
                HeldOut::Folds(folds) => format!("--folds={folds}"),
                HeldOut::Share(share) => format!("--held-out={share}"),
                _ => "--held-out=0".to_owned(),
            },
            match options.degree {
                Degree::Fixed(degree) => format!("--degree={degree}"),
                Degree::UpTo(_) => "--degree=evidence".to_owned(),
            },
            match options.weighting {
                Weighting::Stated => "--noise=stated".to_owned(),
                Weighting::Estimated => "--noise=estimated".to_owned(),
            },
            flag_of_loss(options.loss),
        ];
        flags.extend(flags_of_fit(&self.with, &self.hold, &self.deviations));
        let equipment = device.equipment();
        if let InputDrumDenominators::Same(length_m) = equipment.denominators {
            flags.push(format!("--input-drum-denominator-m={length_m}"));
        }
        flags.extend(equipment.chain_flags());
        if equipment.denominators == InputDrumDenominators::Paper {
            flags.push("--paper-preset".to_owned());
        }
        flags
    }
}

/// Keeps numbers of a model, and notes how far others may be off.
pub(crate) fn hold(
    model: &mut Model,
    kept: &[String],
    deviations: &[(String, f64)],
) -> Result<(), Error> {
    let deviations = deviations.iter().map(|(word, size)| (word, *size));
    for (word, size) in deviations.chain(kept.iter().map(|word| (word, 0.0))) {
        model.expect_deviation(word, size).map_err(|error| {
            let next = "give such words, separated by commas";
            Error::command_line("arguments", error.to_string(), next)
        })?;
    }
    Ok(())
}

/// The flags of what a model's fit starts from, where they are given.
pub(crate) fn flags_of_fit(
    with: &[String],
    kept: &[String],
    deviations: &[(String, f64)],
) -> Vec<String> {
    let mut flags = Vec::new();
    flags.extend(with.iter().map(|word| format!("--with={word}")));
    let deviations = deviations.iter();
    flags.extend(deviations.map(|(word, size)| format!("--deviation={word}={size}")));
    flags.extend(kept.iter().map(|word| format!("--hold={word}")));
    flags
}

/// The flag of a loss.
pub(crate) fn flag_of_loss(loss: LossChoice) -> String {
    match loss {
        LossChoice::Auto => "--loss=auto".to_owned(),
        LossChoice::Fixed(loss) => format!("--loss={loss}"),
    }
}

/// What is said of motor encoders that are ahead of all else.
fn ahead(device: &Model, recording: &Recording) -> Option<String> {
    let channels = haptical_calibration::channels(device, recording).unwrap_or_default();
    let twin = OtherClock::only(channels.into_iter()).map(|own| own.latency().to_owned());
    let ahead = |own: &DeviceEffect| {
        let delay_s = own.numbers.get("delay_s").copied();
        Ahead::of(&own.name, delay_s, twin.as_slice())
    };
    device.effects.iter().find_map(ahead).map(Ahead::words)
}

impl Found {
    /// Names of the files that are written, the last one only where a fit is rejected.
    pub const FILES: [&str; 4] = IDENTIFICATION_FILES;

    /// What is odd about the device, the log and the result.
    pub fn warnings(&self) -> &[String] {
        &self.result.warnings
    }

    /// The text of a device file of the identified device, without comments on how it came about.
    pub fn to_toml(&self) -> &str {
        &self.toml
    }

    /// The files, as they are written.
    ///
    /// # Errors
    /// A fault of this library alone.
    pub fn files(&self) -> Result<Vec<NewFile<'static>>, Error> {
        let (result, calibration) = (&self.result, &self.calibration);
        let page = page::page(result, calibration, &self.recording)?;
        let [toml_name, json_name, page_name, rejected_name] = Self::FILES;
        let mut files = vec![(page_name, page.into_bytes())];
        if self.is_reproduced {
            files.insert(0, (toml_name, self.device.to_toml().as_bytes().to_vec()));
        }
        if let Some(rejected) = &self.rejected {
            files.push((rejected_name, rejected.as_bytes().to_vec()));
        }
        let mut result = result.clone();
        result.provenance = result.provenance.with_outputs(&files);
        let place = usize::from(self.is_reproduced);
        files.insert(place, (json_name, sealed_json(&result)?.into_bytes()));
        Ok(files)
    }

    /// Writes identified.toml (unless it does not leave what its fit leaves), identified.json, identify.html, where a fit is rejected rejected.toml, and report.html,
    /// an index of the results in the folder: all of them or none. A rejected.toml of an earlier run is removed.
    ///
    /// # Errors
    /// The folder cannot be written to, or a file of these names in it is none that an earlier run wrote:
    /// [`crate::files::write_result`] can overwrite it.
    pub fn write(&self, folder: impl AsRef<Path>) -> Result<Vec<PathBuf>, Error> {
        ResultKind::IDENTIFICATION.write(folder.as_ref(), &self.files()?)
    }
}

impl std::fmt::Display for Found {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        summary::write(formatter, &self.result)
    }
}

/// Nothing before refuses a reading such as 1e308 in a row that the fit did not see.
fn refuse_overflow(
    calibration: &Calibration,
    recording: &Recording,
    log: &Path,
) -> Result<(), Error> {
    let reports = calibration.held_out_channels.iter();
    for report in reports.chain(&calibration.fit_channels) {
        if report.rms_before.is_finite() && report.rms_after.is_finite() {
            continue;
        }
        let by_size = |a: &(usize, &f64), b: &(usize, &f64)| a.1.abs().total_cmp(&b.1.abs());
        let width = (report.before.len() / report.rows.len().max(1)).max(1);
        let largest = report.before.iter().enumerate().max_by(by_size);
        let line = largest.map(|(index, _)| recording.line[report.rows[index / width]]);
        let channel = &report.channel;
        let what = format!("the residual of {channel} is too large to be squared");
        return Err(Error::overflow(what, channel, log, line));
    }
    Ok(())
}
