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
    /// Rows without a gap, with the number of the run (from 0).
    pub(super) pieces: Vec<(Range<usize>, usize)>,
    pub(super) warnings: Vec<String>,
}

impl Inputs {
    pub(super) fn new(device: &Device, log: &Log, drive: Drive<'_>) -> Result<Self, Error> {
        let recording = log.recording.as_ref();
        let path = &log.source().path;
        let refuse = |what: String, next: &str| Error::in_file("log", what, path, next);
        let Some(time_s) = &recording.time_s else {
            let what = "it has no column `t_s`".to_owned();
            return Err(refuse(what, "log the time of each row in s"));
        };
        let pieces = pieces(recording, time_s);
        if pieces.is_empty() {
            let what = "no two of its rows follow each other".to_owned();
            return Err(refuse(what, "log whole motions"));
        }
        let ranges: Vec<Range<usize>> = pieces.iter().map(|(rows, _)| rows.clone()).collect();
        let motions = recording.joint.iter();
        let motions: Vec<_> = motions
            .map(|column| local_motion(column, time_s, &ranges))
            .collect();
        let mut inputs = Self {
            time_s: time_s.clone(),
            theta: motions.iter().map(|motion| motion.value.clone()).collect(),
            dtheta: motions
                .iter()
                .map(|motion| motion.velocity.clone())
                .collect(),
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
                let column = column.ok_or_else(|| {
                    let what = format!("it has no column `{name}`");
                    refuse(what, "log the torque of every drive, or give --controller")
                })?;
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
                let (_, column) = column.ok_or_else(|| {
                    let what = format!("it has no column `{name}`");
                    refuse(what, "log what the controller is told")
                })?;
                whole(&name, column, log)?;
                inputs
                    .command_rate
                    .push(rates(column, time_s, &inputs.pieces));
                inputs.command.push(column.clone());
            }
        }
        Ok(inputs)
    }

    pub(super) fn runs(&self) -> usize {
        self.pieces
            .iter()
            .map(|(_, run)| run + 1)
            .max()
            .unwrap_or(0)
    }
}

/// Refuses a column with a cell that is empty.
fn whole(name: &str, column: &[f64], log: &Log) -> Result<(), Error> {
    let Some(row) = column.iter().position(|value| !value.is_finite()) else {
        return Ok(());
    };
    Err(Error::log_line(
        "log",
        format!("`{name}` is empty"),
        &log.source().path,
        log.recording.line.get(row).copied(),
        "fill the cell or leave the row out",
    ))
}

fn pieces(recording: &Recording, time_s: &[f64]) -> Vec<(Range<usize>, usize)> {
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
                pieces.push((start..row, run));
            }
            start = row;
        }
        run += usize::from(is_end);
    }
    pieces
}

/// Central differences, one-sided at the ends of pieces.
fn rates(column: &[f64], time_s: &[f64], pieces: &[(Range<usize>, usize)]) -> Vec<f64> {
    let mut rates = vec![0.0; column.len()];
    for (rows, _) in pieces {
        for row in rows.clone() {
            let (before, after) = (
                row.saturating_sub(1).max(rows.start),
                (row + 1).min(rows.end - 1),
            );
            rates[row] = (column[after] - column[before]) / (time_s[after] - time_s[before]);
        }
    }
    rates
}
