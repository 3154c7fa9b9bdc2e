//! Work on a whole log: reading it as CSV, diagnosing what a calibration leaves of it.

use std::hint::black_box;

use anyhow::{Context, Result};
use haptical_data::{LogShape, read_log_from, write_log_to};
use haptical_diagnosis::{Options, diagnose};
use haptical_model::{Device, Recording};
use haptical_simulator::{Effect, Effects, HandMotion, MotionSettings, record_motion};
use xtask_blind::rows;
use xtask_paper::{Paper, nominal_device, true_device};

use super::{Job, Workload};

/// Rows of a log of 60 s at 100 Hz.
pub(crate) const LOG_ROWS: usize = 6000;
/// Rows of the same 60 s at 10 Hz: callgrind takes minutes for a diagnosis of all.
const DIAGNOSED_ROWS: usize = 600;
const LOG_S: f64 = 60.0;
const SEED: u64 = 1;

pub(crate) const WORKLOADS: [Workload; 2] = rows! {
    Workload {name what unit units is_long prepare}
    "csv-rows", "reading a log of 60 s at 100 Hz, in memory", "row", LOG_ROWS as u64, false, csv_rows;
    "diagnosis", "diagnosis of a log of 60 s at 10 Hz with a yielding cable at joint 2", "row", DIAGNOSED_ROWS as u64, true, diagnosis;
};

/// The nominal device, and 60 s of one with the paper's deviations and these effects, guided by hand.
pub(crate) fn log(rows: usize, effects: &[Effect]) -> Result<(Device, Recording)> {
    let truth = true_device(&nominal_device(None)?, &Paper::load()?, 1.0)?;
    log_with(
        rows,
        &Effects::new(effects.to_vec())?.with_assumed_roughness(&truth)?,
    )
}

/// The same of a device without the paper's roughness: no other effects than these.
pub(crate) fn log_with(rows: usize, effects: &Effects) -> Result<(Device, Recording)> {
    let nominal = nominal_device(None)?;
    let truth = true_device(&nominal, &Paper::load()?, 1.0)?;
    let settings = MotionSettings {
        motion: HandMotion {
            seconds: LOG_S,
            rate_hz: rows as f64 / LOG_S,
            ..HandMotion::default()
        },
        ..MotionSettings::default()
    };
    let recording = record_motion(&truth, effects, &settings, SEED)?;
    Ok((nominal, recording))
}

fn csv_rows() -> Result<Job> {
    let (device, recording) = log(LOG_ROWS, &[])?;
    let shape = LogShape::from(&device);
    let mut text = Vec::new();
    write_log_to(&mut text, &recording, &shape)?;
    Ok(Box::new(move || {
        let log = read_log_from(text.as_slice(), "log.csv", &shape)?;
        black_box(log.recording.len().checked_sub(LOG_ROWS)).context("rows are missing")?;
        Ok(())
    }))
}

fn diagnosis() -> Result<Job> {
    let soft = Effect::CapstanCompliance {
        joint: 2,
        stiffness_nm_per_rad: 260.0,
    };
    let (device, recording) = log(DIAGNOSED_ROWS, &[soft])?;
    Ok(Box::new(move || {
        black_box(diagnose(&device, &recording, &Options::default())?);
        Ok(())
    }))
}
