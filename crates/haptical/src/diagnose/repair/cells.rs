//! What is done about the faults of a log in its cells.

use std::ops::Range;

use haptical_calibration::Channel;
use haptical_data::{LogColumn, LogEdits};
use haptical_diagnosis::{CauseAnswer, Diagnosis, StepAnswer, outlying_readings};
use haptical_effects::device::{attached, bare};
use haptical_effects::{Ahead, Hook, OtherClock, runs_of};
use haptical_model::{DeviceEffect, Recording};

use super::resample::on_time;
use crate::columns::{columns_of, measured_columns, tracked_columns};
use crate::device::Device;
use crate::diagnose::faults::is_of;
use crate::error::Error;

/// Rows on each side of an event by which its first row is told, where some rows were not looked at.
const BESIDE: usize = 4;
/// The column that a fault is in; none of those that are in several.
fn column_of(cause: &CauseAnswer) -> Option<LogColumn> {
    let hook = haptical_effects::specs()
        .find(|spec| spec.name == cause.effect && spec.log_fault.is_some())?
        .hook;
    let joint = cause.joint.map(|joint| joint - 1);
    match hook {
        Hook::Transmission => joint.map(LogColumn::Joint),
        Hook::ExternalEncoder => joint.map(LogColumn::Output),
        Hook::CableSensor => Some(LogColumn::Cable(0)),
        _ => None,
    }
}

/// The columns of a cause that are late, and by how much \[s\]: of motor encoders that are ahead of one kind of sensor those of
/// that sensor.
fn late_columns(cause: &CauseAnswer, delay_s: f64, recording: &Recording) -> (Vec<LogColumn>, f64) {
    let late = cause.ahead().and_then(Ahead::late);
    let is_of_tracker = OtherClock::of_latency(&cause.effect) == Some(OtherClock::Tracker);
    let columns = |clock: OtherClock| -> Vec<LogColumn> {
        match clock {
            OtherClock::Tracker => tracked_columns().collect(),
            OtherClock::Cables => (0..recording.cable_m.len()).map(LogColumn::Cable).collect(),
            OtherClock::ExternalEncoders => {
                (0..recording.output.len()).map(LogColumn::Output).collect()
            }
        }
    };
    match (late, column_of(cause)) {
        (Some(clock), _) => (columns(clock), -delay_s),
        (None, Some(column)) => (vec![column], delay_s),
        (None, None) if is_of_tracker => (columns(OtherClock::Tracker), delay_s),
        (None, None) => {
            let joints = (0..recording.joint.len()).map(LogColumn::Joint);
            (joints.collect(), delay_s)
        }
    }
}

/// A log that is set right, fault after fault.
pub(super) struct Repairing<'r> {
    pub(super) device: &'r Device,
    pub(super) diagnosis: &'r Diagnosis,
    /// With what was set right so far.
    pub(super) recording: Recording,
    pub(super) edits: LogEdits,
    pub(super) runs: Vec<Range<usize>>,
}

impl<'r> Repairing<'r> {
    pub(super) fn new(device: &'r Device, recording: &Recording, diagnosis: &'r Diagnosis) -> Self {
        Self {
            device,
            diagnosis,
            recording: recording.clone(),
            edits: LogEdits::default(),
            runs: runs_of(recording),
        }
    }

    fn set(&mut self, edits: &LogEdits) {
        self.recording = edits.made_in(&self.recording);
        for (column, cells) in edits.columns() {
            for (row, value) in cells {
                match value {
                    Some(value) => self.edits.set(column, *row, *value),
                    None => self.edits.empty(column, *row),
                }
            }
        }
    }

    /// Takes a constant back, from each event of a cause to the end of its run: one change for each.
    pub(super) fn take_steps(&mut self, cause: &CauseAnswer) -> Vec<(LogEdits, f64)> {
        let Some(column) = column_of(cause) else {
            return Vec::new();
        };
        let is_own = |step: &&StepAnswer| step.effect == cause.effect && step.joint == cause.joint;
        let steps: Vec<StepAnswer> =
            (self.diagnosis.steps.iter().filter(is_own).cloned()).collect();
        let mut made = Vec::new();
        for step in steps {
            // what the channels read too much; of a motor encoder, what it reads too little
            let by = match column {
                LogColumn::Joint(_) => step.size,
                _ => -step.size,
            };
            let Some(readings) = column.readings(&self.recording) else {
                continue;
            };
            let [first, last] = step.first_row;
            let Some(run) = self.runs.iter().find(|run| run.contains(&last)) else {
                continue;
            };
            let bends = |row: &usize| bends(readings, run, [first, last], *row, by);
            let row = (first.max(run.start)..=last).min_by(|a, b| bends(a).total_cmp(&bends(b)));
            let row = row.unwrap_or(last);
            let mut edits = LogEdits::default();
            for row in row..run.end {
                if readings[row].is_finite() {
                    edits.set(column, row, readings[row] + by);
                }
            }
            self.set(&edits);
            made.push((edits, by));
        }
        made
    }

    /// Takes the course of a drift out of a sensor's readings; none where the course cannot be computed.
    pub(super) fn take_drift(&mut self, cause: &CauseAnswer) -> Result<Option<LogEdits>, Error> {
        let (Some(column), Some(corrected)) = (column_of(cause), &self.diagnosis.corrected) else {
            return Ok(None);
        };
        let Some(entry) = corrected.effects.iter().find(|own| is_of(own, cause)) else {
            return Ok(None);
        };
        let mut alone = bare(corrected);
        alone.effects = vec![DeviceEffect {
            fit: false,
            fitted: Vec::new(),
            ..entry.clone()
        }];
        let path = &self.device.source().path;
        let with = attached(&mut alone, &self.recording)
            .map_err(|error| Error::effect(&error, path, path))?;
        let channel = match column {
            LogColumn::Output(joint) => Channel::Output { joint }.name(),
            _ => Channel::Cable { index: 0 }.name(),
        };
        let (Some(added), Some(readings)) = (
            with.added.iter().find(|added| added.channel == channel),
            column.readings(&self.recording),
        ) else {
            return Ok(None);
        };
        let mut edits = LogEdits::default();
        for (row, (reading, drift)) in readings.iter().zip(&added.readings).enumerate() {
            if reading.is_finite() {
                edits.set(column, row, reading - drift);
            }
        }
        self.set(&edits);
        Ok(Some(edits))
    }

    /// Brings late readings to the times of their rows, and says how late they were \[s\]. Where a motor's reading has none, the row
    /// loses what was measured in it: a row without a joint is none.
    pub(super) fn take_delay(
        &mut self,
        cause: &CauseAnswer,
        delay_s: f64,
    ) -> Option<(LogEdits, f64)> {
        let time_s = self.recording.time_s.as_ref()?;
        let (columns, delay_s) = late_columns(cause, delay_s, &self.recording);
        let over_runs = |readings: &[f64]| -> Vec<Option<f64>> {
            let runs = self.runs.iter().cloned();
            runs.flat_map(|run| on_time(time_s, readings, run, delay_s))
                .collect()
        };
        let turns = columns.contains(&LogColumn::Orientation(0));
        let turned = turns.then(|| turned_alike(&self.recording, &self.runs));
        let turned = (turned.flatten()).map(|parts| unit(parts.map(|part| over_runs(&part))));
        let mut edits = LogEdits::default();
        for column in columns {
            let Some(readings) = column.readings(&self.recording) else {
                continue;
            };
            let of_joint = matches!(column, LogColumn::Joint(_));
            let on_time = match (column, &turned) {
                (LogColumn::Orientation(part), Some(turned)) => turned[part].clone(),
                _ => over_runs(readings),
            };
            let rows = self.runs.iter().cloned().flatten();
            for (row, value) in rows.zip(on_time) {
                match value {
                    Some(value) => edits.set(column, row, value),
                    None if of_joint => self.empty_measured(&mut edits, row),
                    None if readings[row].is_finite() => edits.empty(column, row),
                    None => {}
                }
            }
        }
        self.set(&edits);
        Some((edits, delay_s))
    }

    /// Empties everything that a row measured beside its joints.
    fn empty_measured(&self, edits: &mut LogEdits, row: usize) {
        let recording = &self.recording;
        for column in measured_columns(recording) {
            let readings = column.readings(recording);
            if readings.is_some_and(|readings| readings[row].is_finite()) {
                edits.empty(column, row);
            }
        }
        let texts = [
            (LogColumn::Contact, &recording.contact),
            (LogColumn::Plane, &recording.plane),
        ];
        for (column, ids) in texts {
            if ids.as_ref().is_some_and(|ids| !ids[row].is_empty()) {
                edits.empty(column, row);
            }
        }
    }

    /// Empties the readings that stand alone: of the external encoder of the cause's joint, or of all that is not one.
    pub(super) fn empty_wild(&mut self, cause: &CauseAnswer) -> Result<LogEdits, Error> {
        let path = &self.device.source().path;
        let wild = outlying_readings(&self.diagnosis.device, &self.recording)
            .map_err(|error| Error::diagnosis(&error, path, path))?;
        let is_told = |channel: &Channel| match channel {
            Channel::Output { joint } => cause.joint == Some(joint + 1),
            _ => cause.joint.is_none(),
        };
        let mut edits = LogEdits::default();
        for (channel, row) in wild.into_iter().filter(|(channel, _)| is_told(channel)) {
            for column in columns_of(channel) {
                edits.empty(column, row);
            }
        }
        self.set(&edits);
        Ok(edits)
    }
}

/// The parts of the orientations, each quaternion of the two of one orientation that is nearer to the one before it, so that
/// they can be interpolated; none of a log without orientations.
fn turned_alike(recording: &Recording, runs: &[Range<usize>]) -> Option<[Vec<f64>; 4]> {
    let mut parts = recording.orientation_wxyz.clone()?;
    for run in runs {
        let mut last: Option<[f64; 4]> = None;
        for row in run.clone() {
            let mut own = parts.each_ref().map(|part| part[row]);
            if own.iter().any(|part| !part.is_finite()) {
                continue;
            }
            let along = |last: [f64; 4]| last.iter().zip(own).map(|(a, b)| a * b).sum::<f64>();
            if last.is_some_and(|last| along(last) < 0.0) {
                own = own.map(|part| -part);
                for (part, value) in parts.iter_mut().zip(own) {
                    part[row] = value;
                }
            }
            last = Some(own);
        }
    }
    Some(parts)
}

/// Interpolated quaternions of norm 1.
fn unit(mut parts: [Vec<Option<f64>>; 4]) -> [Vec<Option<f64>>; 4] {
    for row in 0..parts[0].len() {
        let squares = parts.iter().map(|part| part[row].map(|own| own * own));
        let Some(square) = squares.sum::<Option<f64>>() else {
            continue;
        };
        for part in &mut parts {
            part[row] = part[row].map(|own| own / square.sqrt().max(f64::MIN_POSITIVE));
        }
    }
    parts
}

/// Sum of the squared second differences about an event, were `row` the first one after it.
fn bends(
    readings: &[f64],
    run: &Range<usize>,
    [first, last]: [usize; 2],
    row: usize,
    by: f64,
) -> f64 {
    let from = first.saturating_sub(BESIDE).max(run.start);
    let to = (last + BESIDE).min(run.end);
    let repaired: Vec<f64> = (from..to)
        .map(|at| readings[at] + if at >= row { by } else { 0.0 })
        .filter(|reading| reading.is_finite())
        .collect();
    let bend = |three: &[f64]| (three[0] - 2.0 * three[1] + three[2]).powi(2);
    repaired.windows(3).map(bend).sum()
}
