//! The log without what is its own fault: lost counts, late channels, drifts of sensors, wild readings.

mod cells;
mod resample;
mod table;

use std::collections::BTreeMap;

use haptical_data::{LogEdits, LogShape, edit_log, read_log_from, write_log_to};
use haptical_diagnosis::{CauseAnswer, Diagnosis, Verdict};
use haptical_effects::{Ahead, LogFault, spec};
use haptical_model::{Device as Model, Recording};
use serde::Serialize;

use self::cells::Repairing;
use crate::device::Device;
use crate::diagnose::faults::{Fault, faults};
use crate::diagnose::words::placed;
use crate::error::Error;
use crate::files::{Fingerprint, InputFile, NewFile};
use crate::log::Log;

/// Names of a repaired log: plain where the log was plain.
const NAMES: [&str; 2] = ["repaired.csv", "repaired.csv.gz"];
/// Name of the list of what was changed.
const LIST: &str = "repaired.json";

/// What was set right in a log, and what was not.
#[derive(Debug, Clone, Serialize)]
pub struct Repair {
    /// Name of the repaired log; none where nothing was set right.
    pub log: Option<&'static str>,
    /// The log that it was made from.
    pub from: Option<InputFile>,
    /// SHA-256 of the repaired log.
    pub sha256: Option<String>,
    /// What was changed, in the order in which it was done.
    pub changes: Vec<RepairChange>,
    /// Why nothing was, or what stays in the log.
    pub kept: Vec<String>,
    /// The diagnosis of the repaired log, with the same options.
    pub check: Option<RepairCheck>,
    #[serde(skip)]
    bytes: Vec<u8>,
}

/// A change of one column for one cause.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RepairChange {
    /// Name of the effect.
    pub cause: String,
    /// Joint (from 1), where it has one.
    pub joint: Option<usize>,
    /// Column of the log.
    pub column: String,
    /// `added`, `resampled`, `drift-removed` or `emptied`.
    pub what: &'static str,
    /// Number of cells with another number.
    pub changed: usize,
    /// Number of cells that were emptied.
    pub emptied: usize,
    /// First and last line of the log with such a cell.
    pub lines: [u64; 2],
    /// How much, each number with its unit in its name.
    pub by: BTreeMap<String, f64>,
    /// The lines of emptied cells.
    pub emptied_lines: Vec<u64>,
}

/// What the diagnosis says of a repaired log.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RepairCheck {
    /// Its verdict.
    pub verdict: Verdict,
    /// The same in a sentence or two.
    pub answer: String,
    /// Names of its causes, with their joints.
    pub causes: Vec<String>,
}

impl Repair {
    /// Sets right what is the log's fault by a diagnosis of it.
    ///
    /// # Errors
    /// The log's file was changed since it was read, or cannot be read twice.
    pub(super) fn new(device: &Device, log: &Log, diagnosis: &Diagnosis) -> Result<Self, Error> {
        let mut repair = Self {
            log: None,
            from: log.input("log"),
            sha256: None,
            changes: Vec::new(),
            kept: Vec::new(),
            check: None,
            bytes: Vec::new(),
        };
        let found = faults(diagnosis);
        if found.is_empty() {
            repair.kept.push(nothing(diagnosis).to_owned());
            return Ok(repair);
        }
        let mut repairing = Repairing::new(device, &log.recording, diagnosis);
        let shape = LogShape::from(&device.model);
        repair.set_right(&mut repairing, &found, &shape)?;
        let is_own = |cause: &CauseAnswer| {
            (repair.changes.iter()).any(|own| own.cause == cause.effect && own.joint == cause.joint)
        };
        let (own, others): (Vec<&CauseAnswer>, Vec<&CauseAnswer>) =
            (diagnosis.causes.iter()).partition(|cause| is_own(cause));
        repair.kept.extend(others.into_iter().map(stays));
        let ahead = own.into_iter().filter_map(CauseAnswer::ahead);
        let ahead = ahead
            .filter(|own: &Ahead| own.late().is_some())
            .map(Ahead::words);
        let words = "the motor encoders keep their times, and the other sensor is moved";
        repair
            .kept
            .extend(ahead.map(|own| format!("{words}: {own}")));
        if repairing.edits.is_empty() {
            return Ok(repair);
        }
        let (name, bytes) = written(log, &repairing.edits, &shape)?;
        repair.log = Some(name);
        repair.sha256 = Some(Fingerprint::from_bytes(&bytes).sha256);
        repair.bytes = bytes;
        Ok(repair)
    }

    /// Constants and drifts first, then what is late, in the end what is wild.
    fn set_right(
        &mut self,
        repairing: &mut Repairing<'_>,
        found: &[Fault<'_>],
        shape: &LogShape,
    ) -> Result<(), Error> {
        let of = |kind: LogFault| found.iter().filter(move |fault| fault.kind == kind);
        let lines = repairing.recording.line.clone();
        let mut changes = Changes {
            made: &mut self.changes,
            lines: &lines,
            shape,
        };
        for fault in of(LogFault::Step) {
            for (edits, by) in repairing.take_steps(fault.cause) {
                changes.note(fault.cause, "added", &edits, |unit| {
                    let counts = fault.cause.parameters.get("counts");
                    // the counts of the largest step: the others are in its proportion
                    let size = largest(repairing.diagnosis, fault.cause);
                    let counts = counts.map(|own| by.abs() / size * own.value.abs());
                    let counts = counts.map(|counts| ("counts".to_owned(), counts));
                    let sizes = [(format!("added_{unit}"), by)].into_iter();
                    sizes.chain(counts).collect()
                });
            }
        }
        for fault in of(LogFault::Drift) {
            if let Some(edits) = repairing.take_drift(fault.cause)? {
                let parameters = fault.cause.parameters.iter();
                let by = parameters.map(|(name, own)| (name.clone(), own.value));
                let by: BTreeMap<String, f64> = by.collect();
                changes.note(fault.cause, "drift-removed", &edits, |_| by.clone());
            }
        }
        for fault in of(LogFault::Late) {
            let delay_s = fault.cause.parameters.get("delay_s").map(|own| own.value);
            let taken = delay_s.and_then(|delay_s| repairing.take_delay(fault.cause, delay_s));
            if let Some((edits, delay_s)) = taken {
                let by = BTreeMap::from([("delay_s".to_owned(), delay_s)]);
                changes.note(fault.cause, "resampled", &edits, |_| by.clone());
            }
        }
        for fault in of(LogFault::Wild) {
            let edits = repairing.empty_wild(fault.cause)?;
            changes.note(fault.cause, "emptied", &edits, |_| BTreeMap::new());
        }
        Ok(())
    }

    /// What was read of the repaired log, to be diagnosed; none where nothing was set right.
    ///
    /// # Errors
    /// A fault of this library: it does not read what it wrote.
    pub(super) fn recording(&self, device: &Model) -> Result<Option<Recording>, Error> {
        let Some(name) = self.log else {
            return Ok(None);
        };
        let shape = LogShape::from(device);
        let read = read_log_from(&self.bytes[..], name, &shape);
        Ok(Some(read.map_err(Error::internal)?.recording))
    }

    /// With what the diagnosis says of the repaired log.
    pub(super) fn checked(&mut self, again: &Diagnosis, answer: String) {
        let causes = again.causes.iter();
        let causes = causes.map(placed);
        self.check = Some(RepairCheck {
            verdict: again.verdict,
            answer,
            causes: causes.collect(),
        });
    }

    /// Takes what was set right in the log out of a device with the causes; none where nothing else was found.
    pub(super) fn leave_out(&self, corrected: &mut Option<Model>, before: &Model) {
        let Some(model) = corrected else { return };
        let is_repaired = |own: &haptical_model::DeviceEffect| {
            let number = own.joint.map(|joint| joint + 1);
            (self.changes.iter()).any(|change| change.cause == own.name && change.joint == number)
        };
        let found = model.effects.len();
        let mut index = 0;
        model.effects.retain(|own| {
            // those that the device file had stand first
            index += 1;
            index <= before.effects.len() || !is_repaired(own)
        });
        let yields = (0..model.joints.len())
            .any(|joint| model.compliance_rad_per_nm(joint) != before.compliance_rad_per_nm(joint));
        let is_left = model.effects.len() > before.effects.len() || yields;
        if !is_left && model.effects.len() < found {
            *corrected = None;
        }
    }

    /// The repaired log and the list of what was changed; nothing where nothing was.
    ///
    /// # Errors
    /// A fault of this library alone.
    pub(super) fn files(&self) -> Result<Vec<NewFile<'static>>, Error> {
        let Some(name) = self.log else {
            return Ok(Vec::new());
        };
        let list = serde_json::to_string_pretty(self).map_err(Error::internal)? + "\n";
        Ok(vec![(name, self.bytes.clone()), (LIST, list.into_bytes())])
    }
}

/// Size of the largest step of a cause.
fn largest(diagnosis: &Diagnosis, cause: &CauseAnswer) -> f64 {
    let steps = diagnosis.steps.iter();
    let own = steps.filter(|step| step.effect == cause.effect && step.joint == cause.joint);
    own.map(|step| step.size.abs())
        .fold(f64::MIN_POSITIVE, f64::max)
}

/// The list of changes.
struct Changes<'c> {
    made: &'c mut Vec<RepairChange>,
    lines: &'c [u64],
    shape: &'c LogShape,
}

impl Changes<'_> {
    /// Notes the edits for a cause, a change for each column; `by` says how much, in the column's unit.
    fn note(
        &mut self,
        cause: &CauseAnswer,
        what: &'static str,
        edits: &LogEdits,
        by: impl Fn(&str) -> BTreeMap<String, f64>,
    ) {
        for (column, cells) in edits.columns() {
            let line = |row: &usize| self.lines.get(*row).copied().unwrap_or(0);
            let (Some(first), Some(last)) = (cells.keys().next(), cells.keys().next_back()) else {
                continue;
            };
            let empty = cells.iter().filter(|(_, value)| value.is_none());
            let emptied_lines: Vec<u64> = empty.map(|(row, _)| line(row)).collect();
            self.made.push(RepairChange {
                cause: cause.effect.clone(),
                joint: cause.joint,
                column: column.name(self.shape),
                what: match emptied_lines.len() == cells.len() {
                    true => "emptied",
                    false => what,
                },
                changed: cells.len() - emptied_lines.len(),
                emptied: emptied_lines.len(),
                lines: [line(first), line(last)],
                by: by(column.unit(self.shape)),
                emptied_lines,
            });
        }
    }
}

/// The repaired log, as text with all other bytes as they were; of another form than text as a CSV of what was read.
fn written(
    log: &Log,
    edits: &LogEdits,
    shape: &LogShape,
) -> Result<(&'static str, Vec<u8>), Error> {
    let ([plain, packed], recording) = (NAMES, &log.recording);
    if let Some(bytes) = log.read_again()? {
        let name = log.source().name();
        if let Some(edited) = edit_log(&bytes, &name, &recording.line, edits, shape)? {
            let is_packed = bytes.starts_with(&[0x1f, 0x8b]);
            return Ok((if is_packed { packed } else { plain }, edited));
        }
    }
    let mut bytes = Vec::new();
    write_log_to(&mut bytes, &edits.made_in(recording), shape)?;
    Ok((plain, bytes))
}

/// Why nothing is repaired.
fn nothing(diagnosis: &Diagnosis) -> &'static str {
    match diagnosis.verdict {
        Verdict::NoGap => "there is no gap: nothing of the log is to be repaired",
        Verdict::Named => {
            "what was found is of the device, not of the log: it is never repaired there (corrected.toml has it)"
        }
        Verdict::Ambiguous => {
            "the data cannot tell the cause from others: a log is repaired only for a cause that is named"
        }
        Verdict::Unknown => {
            "the cause is unknown: a log is repaired only for a cause that is named"
        }
    }
}

/// Why a cause stays in the log.
fn stays(cause: &CauseAnswer) -> String {
    let name = placed(cause);
    match spec(&cause.effect).and_then(|spec| spec.log_fault) {
        Some(_) => format!("{name} is not sure enough, or cannot be taken out of the log"),
        None => format!("{name} is of the device, and stays in the log"),
    }
}
