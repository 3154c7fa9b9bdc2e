//! Logs that end after a second or three, or have a few rows a second.

use anyhow::{Context, Result};
use haptical_model::Recording;

use super::{Tale, any, effect, words};
use crate::planted::Planted;
use crate::random::Random;
use crate::rig::readings::rounded;
use crate::trial::{Trial, TrialId};
use crate::truth::Besides;

/// Seconds that a short log lasts.
pub(crate) const SECONDS: [f64; 2] = [1.0, 3.0];
/// Rows a second of a thin one.
pub(crate) const RATE_HZ: [f64; 2] = [5.0, 19.0];
/// A refusal says this of what is missing.
const MISSING: [&str; 7] = [
    "record ",
    "are needed",
    "too few",
    "too little",
    "too short",
    "rows a second",
    "Hz",
];
/// Time over which a course is eased in \[s\].
const EASED_S: f64 = 2.0;
const TIME_STEPS: f64 = 1e4;

pub(super) fn draw(number: usize, id: TrialId, random: &mut Random) -> Result<Trial> {
    let is_short = number.is_multiple_of(2);
    let kind = match number / 2 % 2 {
        0 => None,
        _ => Some(effect(0)?),
    };
    let built = any(kind, random)?;
    let rate_hz = built.scene.sensors.rate_hz;
    let rows = built.logs(random).map(|log| -> Result<Recording> {
        let rows = match is_short {
            true => window(log.len(), rate_hz, random),
            false => thinned(log.len(), rate_hz, random)?,
        };
        Ok(cut(&log, &rows))
    });
    let [first, second] = rows;
    let logs = [first?, second?];
    let unnamed = |planted: Planted| Planted {
        right: Vec::new(),
        acceptable: Vec::new(),
        ..planted
    };
    let what = if is_short { "short-time" } else { "short-rows" };
    let beside = kind.map_or(String::new(), |kind| format!("+{}", kind.label));
    let tale = Tale {
        label: what.to_owned() + &beside,
        planted: built.planted(kind).into_iter().map(unnamed).collect(),
        is_unknown: true,
        besides: Besides {
            refusals: words(&MISSING),
            ..Besides::default()
        },
        ..Tale::default()
    };
    tale.trial(id, &built.scene, logs)
}

/// Rows of a few seconds somewhere in the log.
fn window(rows: usize, rate_hz: f64, random: &mut Random) -> Vec<usize> {
    let count = (rate_hz * random.uniform(SECONDS[0], SECONDS[1])) as usize;
    let eased = (EASED_S * rate_hz) as usize;
    let first = eased + random.index(rows - count - eased);
    (first..first + count).collect()
}

/// Every so many rows.
fn thinned(rows: usize, rate_hz: f64, random: &mut Random) -> Result<Vec<usize>> {
    let within = |every: &usize| {
        let rate_hz = rate_hz / *every as f64;
        (RATE_HZ[0]..=RATE_HZ[1]).contains(&rate_hz)
    };
    let every: Vec<usize> = (1..=rows).filter(within).collect();
    let every = random.choose(&every).context("no row is left")?;
    Ok((0..rows).step_by(every).collect())
}

/// These rows as a log of their own.
fn cut(log: &Recording, rows: &[usize]) -> Recording {
    let mut log = log.select(rows);
    log.line = (2..).take(rows.len()).collect();
    if let Some(times) = &mut log.time_s {
        let start_s = times.first().copied().unwrap_or_default();
        for time_s in times {
            *time_s = rounded(*time_s - start_s, TIME_STEPS);
        }
    }
    log
}
