//! How the instructions of a command grow with the rows of its log.

use std::hint::black_box;

use anyhow::{Result, ensure};
use haptical_calibration::{Options, calibrate};
use haptical_diagnosis::diagnose;
use haptical_report::Table;
use haptical_simulator::{Effect, Effects};
use xtask_blind::rows;
use xtask_output::cells;

use super::workloads::{Job, Workload, log, log_with};

/// Most instructions a row of a log, over those of one of half as many rows.
const LARGEST_JUMP: f64 = 1.5;
/// Largest power of the rows that instructions grow by, from the shortest log to the longest.
const LARGEST_EXPONENT: f64 = 1.05;

/// Each command's logs, of twice as many rows from one to the next.
pub(super) const SERIES: [(&str, usize); 4] = [
    ("identify", 4),
    ("identify, an effect missing", 3),
    ("diagnose", 3),
    ("diagnose, an effect missing", 3),
];

/// The logs of [`SERIES`], one after the other.
pub(super) const WORKLOADS: [Workload; 13] = rows! {
    Workload {name what unit units is_long prepare}
    "identify-1000", "identify", "row", 1000, true, identified::<1000>;
    "identify-2000", "identify", "row", 2000, true, identified::<2000>;
    "identify-4000", "identify", "row", 4000, true, identified::<4000>;
    "identify-8000", "identify", "row", 8000, true, identified::<8000>;
    "identify-soft-1000", "identify, an effect missing", "row", 1000, true, identified_soft::<1000>;
    "identify-soft-2000", "identify, an effect missing", "row", 2000, true, identified_soft::<2000>;
    "identify-soft-4000", "identify, an effect missing", "row", 4000, true, identified_soft::<4000>;
    "diagnose-1000", "diagnose", "row", 1000, true, diagnosed::<1000>;
    "diagnose-2000", "diagnose", "row", 2000, true, diagnosed::<2000>;
    "diagnose-4000", "diagnose", "row", 4000, true, diagnosed::<4000>;
    "diagnose-soft-1000", "diagnose, an effect missing", "row", 1000, true, diagnosed_soft::<1000>;
    "diagnose-soft-2000", "diagnose, an effect missing", "row", 2000, true, diagnosed_soft::<2000>;
    "diagnose-soft-4000", "diagnose, an effect missing", "row", 4000, true, diagnosed_soft::<4000>;
};

const SOFT: Effect = Effect::CapstanCompliance {
    joint: 2,
    stiffness_nm_per_rad: 260.0,
};

fn identified<const ROWS: usize>() -> Result<Job> {
    calibration(ROWS, &[])
}

fn identified_soft<const ROWS: usize>() -> Result<Job> {
    calibration(ROWS, &[SOFT])
}

fn calibration(rows: usize, effects: &[Effect]) -> Result<Job> {
    let (device, recording) = log(rows, effects)?;
    Ok(Box::new(move || {
        black_box(calibrate(&device, &recording, &Options::default())?);
        Ok(())
    }))
}

fn diagnosed<const ROWS: usize>() -> Result<Job> {
    diagnosis(ROWS, Vec::new())
}

fn diagnosed_soft<const ROWS: usize>() -> Result<Job> {
    diagnosis(ROWS, vec![SOFT])
}

/// Of a device without roughness: where that is found, and in how many rows, is no matter of growth.
fn diagnosis(rows: usize, effects: Vec<Effect>) -> Result<Job> {
    let (device, recording) = log_with(rows, &Effects::new(effects)?)?;
    Ok(Box::new(move || {
        let options = haptical_diagnosis::Options::default();
        black_box(diagnose(&device, &recording, &options)?);
        Ok(())
    }))
}

/// Prints how counts grow, and refuses a jump or a power of the rows.
pub(super) fn judge(counts: &[(&'static str, u64)]) -> Result<()> {
    let columns = "command | rows | instructions | each row | over half as many";
    let mut table = Table::with_heads("Instructions over the rows of a log", columns);
    let mut failures = Vec::new();
    let mut first = 0;
    for (command, length) in SERIES {
        let places = first..first + length;
        first += length;
        let points: Vec<(f64, f64)> = (places.clone())
            .map(|place| (WORKLOADS[place].units as f64, counts[place].1 as f64))
            .collect();
        for (index, (rows, count)) in points.iter().enumerate() {
            let before = index.checked_sub(1).map(|before| points[before]);
            let jump = before.map(|(few, less)| (count / rows) / (less / few));
            if let Some(jump) = jump.filter(|jump| *jump > LARGEST_JUMP) {
                failures.push(format!(
                    "{command}, {rows} rows: {jump:.2} times the instructions a row of half as many (allowed: {LARGEST_JUMP})"
                ));
            }
            table.push(cells! {
                command, *rows => 0, *count => 0, count / rows => 0, jump => 2,
            })?;
        }
        let exponent = exponent(&points);
        println!("{command}: instructions grow with the power {exponent:.2} of the rows");
        if exponent > LARGEST_EXPONENT {
            failures.push(format!(
                "{command}: a power of {exponent:.2} (allowed: {LARGEST_EXPONENT})"
            ));
        }
    }
    println!("{}", table.to_terminal());
    ensure!(failures.is_empty(), "{}", failures.join("\n"));
    Ok(())
}

/// Power of the rows from the first point to the last.
fn exponent(points: &[(f64, f64)]) -> f64 {
    match (points.first(), points.last()) {
        (Some((few, less)), Some((many, more))) => (more / less).ln() / (many / few).ln(),
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts of each log by its rows.
    fn counts(of: impl Fn(f64) -> f64) -> Vec<(&'static str, u64)> {
        let each = WORKLOADS.iter();
        each.map(|workload| (workload.name, of(workload.units as f64) as u64))
            .collect()
    }

    #[test]
    fn a_jump_and_a_power_are_refused() {
        assert!(judge(&counts(|rows| 1e6 + 2e5 * rows)).is_ok());
        let steep = judge(&counts(|rows| rows.powf(1.2) * 1e5)).unwrap_err();
        assert!(steep.to_string().contains("a power of 1.20"), "{steep}");
        let jump = |rows: f64| 1e6 + rows * if rows >= 4000.0 { 4e5 } else { 1e5 };
        let jump = judge(&counts(jump)).unwrap_err();
        assert!(jump.to_string().contains("4000 rows"), "{jump}");
    }

    #[test]
    fn the_logs_of_a_series_double() {
        assert_eq!(
            SERIES.iter().map(|(_, length)| length).sum::<usize>(),
            WORKLOADS.len()
        );
        let mut first = 0;
        for (command, length) in SERIES {
            let series = &WORKLOADS[first..first + length];
            assert!(series.iter().all(|workload| workload.what == command));
            assert!(
                series
                    .windows(2)
                    .all(|two| two[1].units == 2 * two[0].units)
            );
            first += length;
        }
    }
}
