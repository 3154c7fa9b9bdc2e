//! Poses that are read from a file for every pass, in a process of their own so that its memory can be told.

use std::cell::RefCell;
use std::fs::File;
use std::io::{BufWriter, Read, Write};
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result, bail, ensure};
use haptical_batch::{BatchError, PoseRow, StreamedDistance};
use haptical_identification::{Settings, solve};
use serde::{Deserialize, Serialize};

use super::arms::{Arm, weight};

/// What a process found.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(crate) struct Streamed {
    pub(crate) poses: usize,
    pub(crate) file_bytes: u64,
    /// A plain read of the file.
    pub(crate) read_s: f64,
    /// A pass that only turns text into numbers.
    pub(crate) parse_s: f64,
    /// All passes of the search, parsing included.
    pub(crate) solve_s: f64,
    pub(crate) passes: usize,
    /// Sum of squares over degrees of freedom: 1 for a right answer.
    pub(crate) scatter: f64,
    /// Largest resident memory \[KiB\]; none where the system does not tell.
    pub(crate) peak_kib: Option<u64>,
}

/// Writes the log: joint angles, then the distance.
pub(crate) fn write(path: &Path, arm: &Arm, poses: usize, seed: u64) -> Result<()> {
    let file = File::create(path).with_context(|| path.display().to_string())?;
    let mut file = BufWriter::with_capacity(1 << 20, file);
    arm.record(poses, seed, |angles, distance| {
        for angle in angles {
            write!(file, "{angle:.9},")?;
        }
        writeln!(file, "{distance:.9}")?;
        Ok(())
    })?;
    file.flush()?;
    Ok(())
}

/// Runs [`in_child`] in a new process of this program.
pub(crate) fn run(path: &Path, joints: usize, seed: u64) -> Result<Streamed> {
    let program = std::env::current_exe()?;
    let output = Command::new(program)
        .args(["bench-scaling", "--stream"])
        .arg(path)
        .args(["--joints", &joints.to_string(), "--seed", &seed.to_string()])
        .output()?;
    ensure!(
        output.status.success(),
        "the streaming process: {}",
        String::from_utf8_lossy(&output.stderr).trim()
    );
    Ok(serde_json::from_slice(&output.stdout)?)
}

/// Reads, parses and solves.
pub(crate) fn in_child(path: &Path, arm: &Arm) -> Result<Streamed> {
    let read_s = plain_read_s(path)?;
    let mut poses = 0;
    let from = Instant::now();
    each_row(path, &mut |_, _| {
        poses += 1;
        Ok(())
    })?;
    let parse_s = from.elapsed().as_secs_f64();
    let passes = RefCell::new(0);
    let failed: RefCell<Option<anyhow::Error>> = RefCell::new(None);
    let source = |each: &mut dyn FnMut(PoseRow<'_>) -> Result<(), BatchError>| {
        *passes.borrow_mut() += 1;
        let mut refused = None;
        let read = each_row(path, &mut |joints, distance_m| {
            let weight = weight();
            each(PoseRow {
                joints,
                distance_m,
                weight,
            })
            .map_err(|error| {
                refused = Some(error.clone());
                error.into()
            })
        });
        match (read, refused) {
            (Ok(()), _) => Ok(()),
            (Err(_), Some(error)) => Err(error),
            (Err(error), None) => {
                *failed.borrow_mut() = Some(error);
                Err(BatchError::NoPose)
            }
        }
    };
    let problem = StreamedDistance::new(&arm.model, source);
    let from = Instant::now();
    let settings = Settings {
        cost_tolerance: 1e-8,
        ..Settings::default()
    };
    let fit = solve(&problem, &arm.model.start(), &arm.free, &settings);
    let solve_s = from.elapsed().as_secs_f64();
    if let Some(error) = failed.take() {
        return Err(error);
    }
    Ok(Streamed {
        poses,
        file_bytes: std::fs::metadata(path)?.len(),
        read_s,
        parse_s,
        solve_s,
        passes: passes.take(),
        scatter: fit?.cost / (poses - arm.free.len()) as f64,
        peak_kib: peak_kib(),
    })
}

fn plain_read_s(path: &Path) -> Result<f64> {
    let from = Instant::now();
    let mut file = File::open(path)?;
    let mut room = vec![0; 1 << 20];
    while file.read(&mut room)? > 0 {}
    Ok(from.elapsed().as_secs_f64())
}

/// Hands every row's joint angles and distance to `each`.
fn each_row(path: &Path, each: &mut dyn FnMut(&[f64], f64) -> Result<()>) -> Result<()> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .buffer_capacity(1 << 20)
        .from_path(path)?;
    let mut record = csv::ByteRecord::new();
    let mut numbers = Vec::new();
    while reader.read_byte_record(&mut record)? {
        numbers.clear();
        for cell in &record {
            let number: f64 = std::str::from_utf8(cell)?.parse()?;
            numbers.push(number);
        }
        let Some((distance, joints)) = numbers.split_last() else {
            bail!("an empty row");
        };
        each(joints, *distance)?;
    }
    Ok(())
}

/// `VmHWM` of proc(5).
fn peak_kib() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse().ok()
}
