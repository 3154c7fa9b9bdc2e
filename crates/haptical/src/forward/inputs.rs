//! What a log gives to a prediction: runs, smooth positions and velocities, torques or commands.

use std::ops::Range;

use haptical_effects::signal::local_motion;
use haptical_model::Recording;

use super::Drive;
use crate::device::Device;
use crate::error::Error;
use crate::log::Log;

/// A gap between two rows of a run that is this many times as long as the usual one ends a piece.
const GAP: f64 = 5.0;

/// Rows of a run without a gap.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Piece {
    pub(super) rows: Range<usize>,
    /// Those of them at which the torque of every drive is known.
    pub(super) predicted: Range<usize>,
    /// Number of the run (from 0).
    pub(super) run: usize,
}

/// Columns of the log by joint, and the pieces without gaps.
#[derive(Debug)]
pub(super) struct Inputs {
    pub(super) time_s: Vec<f64>,
    /// Smoothed positions and velocities.
    pub(super) theta: Vec<Vec<f64>>,
    pub(super) dtheta: Vec<Vec<f64>>,
    /// Torques; empty where they are not asked for.
    pub(super) torque: Vec<Vec<f64>>,
    /// Commands with their velocities; empty where they are not asked for.
    pub(super) command: Vec<Vec<f64>>,
    pub(super) command_rate: Vec<Vec<f64>>,
    pub(super) pieces: Vec<Piece>,
    pub(super) warnings: Vec<String>,
}

impl Inputs {
    /// `delays_s`: how long after they act the torques are logged, of all joints of all devices.
    pub(super) fn new(
        device: &Device,
        log: &Log,
        drive: Drive<'_>,
        delays_s: &[f64],
    ) -> Result<Self, Error> {
        let recording = log.recording.as_ref();
        let path = &log.source().path;
        let refuse = |said: &str| Error::of_file("log", said, path);
        let lacks = |name: &str, next: &str| refuse(&format!("it has no column `{name}`; {next}"));
        let Some(time_s) = &recording.time_s else {
            return Err(lacks("t_s", "log the time of each row in s"));
        };
        let pieces = pieces(recording, time_s);
        if pieces.is_empty() {
            let said = "no two of its rows follow each other; log whole motions";
            return Err(refuse(said));
        }
        let ranges: Vec<Range<usize>> = pieces.iter().map(|own| own.rows.clone()).collect();
        let motions = recording.joint.iter();
        let motions = motions.map(|column| local_motion(column, time_s, &ranges));
        let (theta, dtheta) = motions.map(|own| (own.value, own.velocity)).unzip();
        let mut inputs = Self {
            time_s: time_s.clone(),
            theta,
            dtheta,
            torque: Vec::new(),
            command: Vec::new(),
            command_rate: Vec::new(),
            pieces,
            warnings: Vec::new(),
        };
        // torques are compared with a controller's, where they are logged
        let has_all = recording.torque_nm.iter().all(Option::is_some);
        if matches!(drive, Drive::Torques) || has_all && !recording.torque_nm.is_empty() {
            for (joint, own) in device.model.joints.iter().enumerate() {
                let name = own.torque_column(joint + 1);
                let column = recording.torque_nm.get(joint).and_then(Option::as_ref);
                let next = "log the torque of every drive, or give --controller";
                let column = column.ok_or_else(|| lacks(&name, next))?;
                inputs.torque.push(column.clone());
                if matches!(drive, Drive::Torques) {
                    whole(&name, column, log)?;
                }
            }
        }
        if let Drive::Controller(_) = drive {
            for (joint, own) in device.model.joints.iter().enumerate() {
                let name = format!("command{}_{}", joint + 1, own.unit());
                let own = |(column, _): &&(String, Vec<f64>)| *column == name;
                let column = recording.covariates.iter().find(own);
                let missing = || lacks(&name, "log what the controller is told");
                let (_, column) = column.ok_or_else(missing)?;
                whole(&name, column, log)?;
                let rates = rates(column, time_s, &inputs.pieces);
                inputs.command_rate.push(rates);
                inputs.command.push(column.clone());
            }
        }
        if !inputs.torque.is_empty() {
            inputs.keep_known_torques(delays_s);
        }
        if inputs.pieces.is_empty() {
            let said = "its runs are shorter than `torque_delay_s` of the device; correct torque_delay_s in the device file";
            return Err(refuse(said));
        }
        Ok(inputs)
    }

    /// Leaves out the rows whose torques were logged before or after their piece.
    fn keep_known_torques(&mut self, delays_s: &[f64]) {
        let latest_s = delays_s.iter().copied().fold(0.0, f64::max);
        let earliest_s = delays_s.iter().copied().fold(0.0, f64::min);
        let mut left_out = 0;
        for piece in &mut self.pieces {
            let time_s = &self.time_s[piece.rows.clone()];
            let (first_s, last_s) = (time_s[0], time_s[time_s.len() - 1]);
            let before = time_s.partition_point(|own| own + earliest_s < first_s);
            let count = time_s.partition_point(|own| own + latest_s <= last_s);
            let begin = piece.rows.start + before;
            let end = (piece.rows.start + count).max(begin);
            left_out += piece.rows.len() - (end - begin);
            piece.predicted = begin..end;
        }
        self.pieces.retain(|piece| piece.predicted.len() > 1);
        if left_out > 0 {
            self.warnings.push(format!(
                "{left_out} rows at the ends of runs are not predicted: their torques were logged outside of the run \
                 (torque_delay_s)"
            ));
        }
    }

    /// What the torque of a joint read at a time within a piece, in straight lines from row to row.
    pub(super) fn torque_at(&self, joint: usize, piece: &Piece, at_s: f64) -> f64 {
        let (time_s, torque) = (&self.time_s[piece.rows.clone()], &self.torque[joint]);
        let after = time_s.partition_point(|own| *own < at_s);
        let after = after.clamp(1, time_s.len() - 1);
        let share = (at_s - time_s[after - 1]) / (time_s[after] - time_s[after - 1]);
        let row = piece.rows.start + after;
        let (from, to) = (torque[row - 1], torque[row]);
        from + share.clamp(0.0, 1.0) * (to - from)
    }

    pub(super) fn runs(&self) -> usize {
        let runs = self.pieces.iter().map(|piece| piece.run + 1);
        runs.max().unwrap_or(0)
    }
}

/// Refuses a column with a cell that is empty.
fn whole(name: &str, column: &[f64], log: &Log) -> Result<(), Error> {
    let Some(row) = column.iter().position(|value| !value.is_finite()) else {
        return Ok(());
    };
    let (what, next) = (
        format!("`{name}` is empty"),
        "fill the cell or leave the row out",
    );
    Err(log.refuse_row("log", what, row, next))
}

fn pieces(recording: &Recording, time_s: &[f64]) -> Vec<Piece> {
    let count = recording.len();
    let is_same = |row: usize| recording.run_at(row) == recording.run_at(row - 1);
    let mut gaps: Vec<f64> = (1..count)
        .filter(|row| is_same(*row))
        .map(|row| time_s[row] - time_s[row - 1])
        .collect();
    gaps.sort_by(f64::total_cmp);
    let usual = gaps.get(gaps.len() / 2).copied().unwrap_or(0.0);
    let (mut pieces, mut start, mut run) = (Vec::new(), 0, 0);
    for row in 1..=count {
        let is_end = row == count || !is_same(row);
        if is_end || time_s[row] - time_s[row - 1] > GAP * usual {
            if row - start > 1 {
                pieces.push(Piece {
                    rows: start..row,
                    predicted: start..row,
                    run,
                });
            }
            start = row;
        }
        run += usize::from(is_end);
    }
    pieces
}

/// Central differences, one-sided at the ends of pieces.
fn rates(column: &[f64], time_s: &[f64], pieces: &[Piece]) -> Vec<f64> {
    let mut rates = vec![0.0; column.len()];
    for Piece { rows, .. } in pieces {
        for row in rows.clone() {
            let before = row.saturating_sub(1).max(rows.start);
            let after = (row + 1).min(rows.end - 1);
            rates[row] = (column[after] - column[before]) / (time_s[after] - time_s[before]);
        }
    }
    rates
}
