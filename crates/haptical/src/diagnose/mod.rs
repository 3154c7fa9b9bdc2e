//! Diagnosis: what a calibration leaves, which effect causes it, and how much of it that effect closes.

mod absorbed;
mod adjusted;
#[cfg(test)]
mod agreement_tests;
mod commands;
mod corrected;
mod drives;
#[cfg(test)]
mod example_tests;
mod faults;
mod joints;
mod kept;
mod next;
mod page;
pub(crate) mod quantity;
mod refitted;
mod repair;
mod rest;
mod several;
mod summary;
pub(crate) mod words;

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use haptical_calibration::LossChoice;
use haptical_diagnosis::{
    BOOTSTRAP_SEED, Catalogue, CauseAnswer, ChannelGap, Diagnosis, Options, Prediction, Provenance,
    Verdict, diagnose as diagnose_recording,
};
use haptical_effects::structure::JOINT_COMPLIANCE;
use haptical_identification::Interrupt;
use haptical_model::Recording;
use haptical_report::Block;

use serde::Serialize;

use crate::device::{Device, refuse_other_device};
use crate::error::Error;
use crate::files::{DIAGNOSIS_FILES, NewFile, Record, ResultKind, VERSION, sealed_json};
use crate::identify::{flag_of_loss, flags_of_fit, hold};
use crate::lines::labelled;
use crate::log::Log;
use crate::page::arm;

pub use self::commands::NextCommand;
pub use self::repair::{Repair, RepairChange, RepairCheck};
pub(crate) use self::several::joined;
use self::several::{LogRead, refuse_same_log, refuse_without_readings};
use self::summary::Room;

/// Header of predictions.csv, in the order of [`Prediction`].
const PREDICTION_COLUMNS: [&str; 5] = ["row", "channel", "measured", "before", "after"];

/// What a diagnosis is asked for; the default is what `haptical diagnose` does without flags.
#[derive(Debug, Clone, Default)]
pub struct Diagnose<'a> {
    /// Effects to leave out of the catalogue.
    pub without: Vec<String>,
    /// Effects of the caller, tested like those of the catalogue; `haptical verify` does not know them.
    pub own_effects: Option<Catalogue>,
    /// A model identified earlier: what the device deviates from it is part of the gap.
    pub model: Option<&'a Device>,
    /// Further logs of the device with the same columns, judged together with the first one.
    pub also: Vec<&'a Log>,
    /// Another log of the device, on which the shrink is measured; without it blocks of the log are held out.
    pub validate: Option<&'a Log>,
    /// What large residuals cost in the fit of the base model.
    pub loss: LossChoice,
    /// Whether the base model has what joints yield to their torque.
    pub joint_compliance: bool,
    /// Numbers of the links that are kept, as [`Identify::hold`](crate::Identify).
    pub hold: Vec<String>,
    /// How far such numbers may plausibly be off \[m\] or \[rad\].
    pub deviations: Vec<(String, f64)>,
    /// Stops the diagnosis from another thread.
    pub interrupt: Interrupt,
    /// Whether to write the log without what is its own fault, and to diagnose that again.
    pub repair: bool,
}

impl Diagnose<'_> {
    /// Flags of the command that decide the result, but for files.
    fn flags(&self, device: &Device) -> Vec<String> {
        let mut flags: Vec<String> = device.equipment().chain_flags().collect();
        let without = self.without.join(",");
        flags.extend((!without.is_empty()).then(|| format!("--without={without}")));
        flags.extend((self.loss != LossChoice::Auto).then(|| flag_of_loss(self.loss)));
        let with = self
            .joint_compliance
            .then(|| JOINT_COMPLIANCE.name.to_owned());
        flags.extend(flags_of_fit(with.as_slice(), &self.hold, &self.deviations));
        flags.extend(self.repair.then(|| "--repair".to_owned()));
        flags
    }
}

/// A diagnosis with the names and hashes of what it was made from. It prints as the command's answer.
///
/// As JSON it is gap.json: `provenance` holds both what the answer rests on and how the file came about.
#[derive(Debug, Clone, Serialize)]
pub struct Diagnosed {
    /// The answer.
    #[serde(flatten)]
    pub diagnosis: Diagnosis,
    /// The verdict in a sentence or two.
    pub answer: String,
    /// What was set right in the log, where that was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repair: Option<Repair>,
    /// The text of corrected.toml.
    #[serde(skip)]
    corrected: Option<String>,
    /// The arm as given and as corrected.
    #[serde(skip)]
    arm: Option<Block>,
    /// Names of the joints of the answer.
    #[serde(skip)]
    joints: Option<String>,
    provenance: GapProvenance,
    haptical_version: String,
    device: String,
    log: String,
    /// Of several logs that were judged together.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    logs: Vec<LogRead>,
    validate: Option<String>,
    model: Option<String>,
}

#[derive(Debug, Clone, Serialize)]
struct GapProvenance {
    #[serde(flatten)]
    answer: Provenance,
    #[serde(flatten)]
    record: Record,
}

/// A cause of a gap; it prints as a sentence.
#[derive(Debug, Clone, Copy)]
pub struct Cause<'a>(pub &'a CauseAnswer);

/// Identifies a device from a log, then says which effect causes what is left between model and measurement.
///
/// # Errors
/// [`ErrorKind::Unidentifiable`](crate::ErrorKind) where the log fixes nothing, otherwise what is wrong with a
/// reading, the device or an option, and where; a second log that is the first one;
/// [`ErrorKind::Interrupted`](crate::ErrorKind) after a request of `options.interrupt`.
pub fn diagnose(device: &Device, log: &Log, options: &Diagnose<'_>) -> Result<Diagnosed, Error> {
    diagnose_as(VERSION, device, log, options)
}

/// The same under the name of another version, for a result that is made again.
///
/// # Errors
/// As [`diagnose`].
pub fn diagnose_as(
    version: &str,
    device: &Device,
    log: &Log,
    options: &Diagnose<'_>,
) -> Result<Diagnosed, Error> {
    let (model, validate, interrupt) = (options.model, options.validate, &options.interrupt);
    if let Some(model) = model {
        refuse_other_device(&device.model, &model.model, &model.source().path)?;
    }
    let logs: Vec<&Log> = std::iter::once(log)
        .chain(options.also.iter().copied())
        .collect();
    let recording = joined(&logs)?;
    if options.repair && logs.len() > 1 {
        let said = "--repair with several logs: one log is repaired at a time; leave --repair out, or give one log";
        return Err(Error::arguments(said));
    }
    if let Some(second) = validate {
        logs.iter()
            .try_for_each(|log| refuse_same_log(log, second))?;
        refuse_without_readings(device, &recording, second)?;
    }
    let mut described = device.model.clone();
    if options.joint_compliance {
        described.fit_compliance();
    }
    hold(&mut described, &options.hold, &options.deviations)?;
    let request = Options {
        loss: options.loss,
        without: options.without.clone(),
        own_effects: options.own_effects,
        model: model.map(|model| &model.model),
        validation: validate.map(|log| log.recording.as_ref()),
        interrupt: interrupt.clone(),
    };
    let (device_path, log_path) = (&device.source().path, &log.source().path);
    let diagnosis = diagnose_recording(&described, &recording, &request);
    Error::unless_interrupted(interrupt, log_path)?;
    let mut diagnosis = diagnosis
        .map_err(|error| Error::diagnosis(&error, device_path, log_path).with_equipment(device))?;
    refuse_overflow(&diagnosis, log_path)?;
    let fitted = match logs.as_slice() {
        [log] => Cow::Borrowed(*log),
        _ => Cow::Owned(log.with_recording(recording.as_ref().clone())),
    };
    drives::fill(device, (&fitted, validate), &mut diagnosis);
    let reproduced = corrected::reproduced(device, &fitted, &diagnosis);
    let repair = match options.repair {
        true => Some(repaired(device, log, &described, &request, &mut diagnosis)?),
        false => None,
    };
    let reproduced = beside_repair(device, log, &diagnosis, (repair.as_ref(), reproduced))?;
    corrected::tell(&mut diagnosis, reproduced);
    Error::unless_interrupted(interrupt, log_path)?;
    let arm = arm_of(model.unwrap_or(device), &diagnosis, &recording)?;
    let own = std::mem::take(&mut diagnosis.warnings);
    let of_logs = logs.iter().map(|log| &log.warnings);
    let further = [
        model.map(|own| &own.warnings),
        validate.map(|log| &log.warnings),
    ];
    let read = std::iter::once(&device.warnings).chain(of_logs);
    let read = read.chain(further.into_iter().flatten()).flatten().cloned();
    let anew = refitted::refitted(device, &logs).filter(|_| model.is_none());
    diagnosis.warnings = anew.into_iter().chain(read).chain(own).collect();
    let mut files = device.inputs("device");
    files.extend(logs.iter().filter_map(|log| log.input("log")));
    files.extend(model.iter().flat_map(|model| model.inputs("model")));
    files.extend(validate.and_then(|log| log.input("validate")));
    let mut record = Record::of(version, "diagnose", files, options.flags(device));
    record.seeds.insert("bootstrap", BOOTSTRAP_SEED);
    Ok(Diagnosed {
        provenance: GapProvenance {
            answer: diagnosis.provenance.clone(),
            record,
        },
        answer: summary::answer(&diagnosis),
        corrected: corrected::commented(device, &diagnosis)?,
        arm,
        joints: joints::named(device, &diagnosis),
        repair,
        diagnosis,
        haptical_version: version.to_owned(),
        device: device.source().label.clone(),
        log: log.source().label.clone(),
        logs: several::read(&logs),
        validate: validate.map(|log| log.source().label.clone()),
        model: model.map(|model| model.source().label.clone()),
    })
}

/// What a replay of corrected.toml leaves of each channel, or why the file is not written.
type Reproduced = Result<Option<Vec<(String, f64)>>, String>;

/// Whether corrected.toml holds its fit: what was set right in the log is no part of the device, and shows in the log as it was.
fn beside_repair(
    device: &Device,
    log: &Log,
    diagnosis: &Diagnosis,
    (repair, reproduced): (Option<&Repair>, Reproduced),
) -> Result<Reproduced, Error> {
    let (Some(repair), Err(_)) = (repair, &reproduced) else {
        return Ok(reproduced);
    };
    Ok(match repair.recording(&device.model)? {
        Some(own) => corrected::reproduced(device, &log.with_recording(own), diagnosis),
        None => reproduced,
    })
}

/// The arm as given and as corrected; none where nothing is.
fn arm_of(
    given: &Device,
    diagnosis: &Diagnosis,
    recording: &Recording,
) -> Result<Option<Block>, Error> {
    let Some(corrected) = &diagnosis.corrected else {
        return Ok(None);
    };
    arm::picture(&given.model, corrected, recording, "as corrected")
}

/// The log set right by its diagnosis, and diagnosed again; what was set right is no part of the device with the causes.
fn repaired(
    device: &Device,
    log: &Log,
    described: &haptical_model::Device,
    request: &Options<'_>,
    diagnosis: &mut Diagnosis,
) -> Result<Repair, Error> {
    let mut repair = Repair::new(device, log, diagnosis)?;
    if let Some(recording) = repair.recording(&device.model)? {
        let (device_path, log_path) = (&device.source().path, &log.source().path);
        let again = diagnose_recording(described, &recording, request)
            .map_err(|error| Error::diagnosis(&error, device_path, log_path))?;
        let answer = summary::answer(&again);
        repair.checked(&again, answer);
    }
    repair.leave_out(&mut diagnosis.corrected, described);
    Ok(repair)
}

impl Diagnosed {
    /// Names of the files that are written; the third with a second log only, the fourth where a cause is named that is part of
    /// a device, of the last three two where a log was repaired.
    pub const FILES: [&str; 7] = DIAGNOSIS_FILES;

    /// What is odd about the device, the logs and the result.
    pub fn warnings(&self) -> &[String] {
        &self.diagnosis.warnings
    }

    /// The first cause, where the verdict is that the causes explain the gap.
    pub fn named(&self) -> Option<Cause<'_>> {
        let named = self.diagnosis.verdict == Verdict::Named;
        self.diagnosis.causes.first().filter(|_| named).map(Cause)
    }

    /// The text of corrected.toml, without its record of files: the device with geometry and drives fitted together with
    /// the causes, and the causes as `[[effect]]` tables; none where no cause is part of a device.
    pub fn corrected_toml(&self) -> Option<&str> {
        self.corrected.as_deref()
    }

    /// Name of the log without its faults, where one is written.
    fn repaired_log(&self) -> Option<&str> {
        self.repair.as_ref()?.log
    }

    /// Commands that go on from here.
    pub fn commands(&self) -> Vec<NextCommand> {
        commands::commands(
            &self.diagnosis,
            &self.provenance.record,
            self.repaired_log(),
        )
    }

    /// The files, as they are written.
    ///
    /// # Errors
    /// A fault of this library alone.
    pub fn files(&self) -> Result<Vec<NewFile<'static>>, Error> {
        let [json_name, page_name, predictions_name, corrected_name, ..] = Self::FILES;
        let besides = page::Besides {
            repaired: self.repaired_log(),
            arm: self.arm.as_ref(),
            joints: self.joints.as_deref(),
            record: &self.provenance.record,
        };
        let page = page::page(&self.diagnosis, besides)?;
        let mut files = vec![(page_name, page.into_bytes())];
        if self.validate.is_some() {
            let predictions = predictions_csv(&self.diagnosis.predictions)?;
            files.push((predictions_name, predictions));
        }
        if let Some(corrected) = &self.corrected {
            let text = self.provenance.record.toml_comments()? + corrected;
            files.push((corrected_name, text.into_bytes()));
        }
        if let Some(repair) = &self.repair {
            files.extend(repair.files()?);
        }
        let mut sealed = self.clone();
        sealed.provenance.record = self.provenance.record.with_outputs(&files);
        files.insert(0, (json_name, sealed_json(&sealed)?.into_bytes()));
        Ok(files)
    }

    /// Writes gap.json, gap.html, with a second log predictions.csv, with a cause that is part of a device corrected.toml, with
    /// a repair of the log repaired.csv and repaired.json, and
    /// report.html, an index of the results in the folder: all of them or none. A file of these of an earlier run is removed.
    ///
    /// # Errors
    /// The folder cannot be written to, or a file of these names in it is none that an earlier run wrote:
    /// [`crate::files::write_result`] can overwrite it.
    pub fn write(&self, folder: impl AsRef<Path>) -> Result<Vec<PathBuf>, Error> {
        ResultKind::DIAGNOSIS.write(folder.as_ref(), &self.files()?)
    }

    /// The answer in fewer than 25 lines, for a terminal: what is too long for them ends in a mark. What is printed by
    /// `Display` has every word.
    pub fn brief(&self) -> String {
        self.said(Room::Terminal)
    }

    fn said(&self, room: Room) -> String {
        let mut said = summary::text(&self.diagnosis, self.repaired_log(), room);
        if let Some(names) = &self.joints {
            said += &labelled("joints", names, 9);
        }
        if let Some(words) = several::words(&self.logs) {
            said += &format!("{:<9}{words}\n", "logs");
        }
        if let Some(repair) = &self.repair {
            said += &repair.to_string();
        }
        said
    }
}

impl std::fmt::Display for Diagnosed {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(&self.said(Room::Any))
    }
}

impl std::fmt::Display for Cause<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(&summary::cause(self.0))
    }
}

/// Nothing before refuses a reading such as 1e300.
fn refuse_overflow(diagnosis: &Diagnosis, log: &Path) -> Result<(), Error> {
    let is_odd = |channel: &&ChannelGap| {
        let sizes = [channel.rms_before, channel.rms_after, channel.noise_floor];
        sizes.iter().any(|size| !size.is_finite())
    };
    match diagnosis.gap.channels.iter().find(is_odd) {
        None => Ok(()),
        Some(ChannelGap { channel, .. }) => {
            let what = format!("a residual of {channel} is too large to be squared");
            Err(Error::overflow(what, channel, log, None))
        }
    }
}

/// predictions.csv: a header even without rows.
fn predictions_csv(predictions: &[Prediction]) -> Result<Vec<u8>, Error> {
    let mut writer = csv::WriterBuilder::new();
    let mut writer = writer.has_headers(false).from_writer(Vec::new());
    let written = writer.write_record(PREDICTION_COLUMNS);
    written.map_err(Error::internal)?;
    for prediction in predictions {
        writer.serialize(prediction).map_err(Error::internal)?;
    }
    writer.into_inner().map_err(Error::internal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn predictions_keep_all_digits_and_have_a_header() {
        let row = Prediction {
            row: 7,
            channel: "out2".to_owned(),
            measured: 0.1 + 0.2,
            before: -1e-9,
            after: 0.25,
        };
        let text = String::from_utf8(predictions_csv(&[row]).unwrap()).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "row,channel,measured,before,after");
        let cells: Vec<&str> = lines[1].split(',').collect();
        assert_eq!(cells[..2], ["7", "out2"]);
        let numbers: Vec<f64> = cells[2..]
            .iter()
            .map(|cell| cell.parse().unwrap())
            .collect();
        assert_eq!(numbers, [0.1 + 0.2, -1e-9, 0.25]);
        let empty = String::from_utf8(predictions_csv(&[]).unwrap()).unwrap();
        assert_eq!(empty, "row,channel,measured,before,after\n");
    }
}
