//! Rows that a recorder lost or wrote twice.

use std::ops::Range;

use super::EpisodeLog;
use super::series::step_s;
use crate::effect::recording;
use crate::thresholds::{
    JUMP_NEIGHBOURS, JUMP_RATIO, JUMP_REST, LOST_STEPS, REPEATED_SHARE, REPEATED_STEP,
};

/// A fault of an episode's rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowFaultKind {
    /// Times between which rows are missing.
    Lost,
    /// Positions and commands that all jump from one row to the next, while the times go on evenly: the rows between were lost
    /// before the times were made. How many is an estimate.
    Jump,
    /// Fewer rows than the recording's own description says.
    Short,
    /// Rows whose positions are all those of the row before, amid a motion.
    Repeated,
}

impl RowFaultKind {
    /// Name of the effect.
    pub fn effect(self) -> &'static str {
        match self {
            Self::Lost | Self::Jump | Self::Short => recording::LOST,
            Self::Repeated => recording::REPEATED,
        }
    }
}

/// Rows of an episode that are lost or repeated.
#[derive(Debug, Clone, PartialEq)]
pub struct RowFault {
    /// Which.
    pub kind: RowFaultKind,
    /// Index of the episode.
    pub episode: usize,
    /// How many.
    pub rows: usize,
    /// Of how many that the episode has or should have.
    pub of: usize,
    /// Where the first ones are, from the episode's first row \[s\]; none where it is not known.
    pub first_s: Option<f64>,
}

/// Of all episodes, in their order.
pub(super) fn faults(log: &EpisodeLog<'_>) -> Vec<RowFault> {
    let step = step_s(log);
    let scales = Scales::new(log);
    let each = 0..log.episodes.len();
    each.flat_map(|episode| {
        let lost = lost(log, episode, step)
            .or_else(|| short(log, episode))
            .or_else(|| jump(log, episode, &scales));
        [lost, repeated(log, episode, &scales)]
    })
    .flatten()
    .collect()
}

fn lost(log: &EpisodeLog<'_>, episode: usize, step: f64) -> Option<RowFault> {
    let own = &log.time_s[log.episodes[episode].clone()];
    let gaps = own.windows(2).map(|pair| [pair[0], pair[1] - pair[0]]);
    let gaps: Vec<[f64; 2]> = gaps.filter(|gap| gap[1] > LOST_STEPS * step).collect();
    let first = gaps.first()?;
    let rows = gaps
        .iter()
        .map(|gap| (gap[1] / step).round() as usize - 1)
        .sum();
    Some(RowFault {
        kind: RowFaultKind::Lost,
        episode,
        rows,
        of: own.len() + rows,
        first_s: Some(first[0] - own[0]),
    })
}

fn short(log: &EpisodeLog<'_>, episode: usize) -> Option<RowFault> {
    let (has, should) = (
        log.episodes[episode].len(),
        *log.described_rows.get(episode)?,
    );
    (should > has).then_some(RowFault {
        kind: RowFaultKind::Short,
        episode,
        rows: should - has,
        of: should,
        first_s: None,
    })
}

/// The usual step of each column from one row to the next: its root mean square.
struct Scales {
    position: Vec<f64>,
    command: Vec<f64>,
}

impl Scales {
    fn new(log: &EpisodeLog<'_>) -> Self {
        let of = |column: &[f64]| {
            let rows = log.episodes.iter().flat_map(|rows| rows.clone().skip(1));
            let steps = rows
                .map(|row| column[row] - column[row - 1])
                .filter(|step| step.is_finite());
            let (sum, count) = steps.fold((0.0, 0.0), |(sum, count), step| {
                (sum + step * step, count + 1.0)
            });
            (sum / f64::max(count, 1.0)).sqrt()
        };
        Self {
            position: log.joints.iter().map(|joint| of(joint.position)).collect(),
            command: log
                .joints
                .iter()
                .map(|joint| joint.command.map_or(0.0, of))
                .collect(),
        }
    }
}

/// Sizes of the steps before each row but the first, all columns together, in usual steps.
fn sizes<'a>(columns: impl Iterator<Item = (&'a [f64], f64)>, rows: &Range<usize>) -> Vec<f64> {
    let mut squares = vec![0.0; rows.len().saturating_sub(1)];
    for (column, scale) in columns.filter(|(_, scale)| *scale > 0.0) {
        for (square, pair) in squares.iter_mut().zip(column[rows.clone()].windows(2)) {
            let step = (pair[1] - pair[0]) / scale;
            *square += if step.is_finite() { step * step } else { 0.0 };
        }
    }
    squares.into_iter().map(f64::sqrt).collect()
}

fn jump(log: &EpisodeLog<'_>, episode: usize, scales: &Scales) -> Option<RowFault> {
    let rows = &log.episodes[episode];
    let position = log
        .joints
        .iter()
        .map(|joint| joint.position)
        .zip(scales.position.iter().copied());
    let command = log.joints.iter().zip(&scales.command);
    let command = command.filter_map(|(joint, scale)| Some((joint.command?, *scale)));
    let (position, command) = (sizes(position, rows), sizes(command, rows));
    // what a jump is of: the largest steps next to it
    let ratio = |sizes: &[f64], at: usize| {
        let near = &sizes[at - JUMP_NEIGHBOURS..=at + JUMP_NEIGHBOURS];
        let others = near
            .iter()
            .enumerate()
            .filter(|(place, _)| *place != JUMP_NEIGHBOURS);
        let most = others.map(|(_, size)| *size).fold(JUMP_REST, f64::max);
        sizes[at] / most
    };
    let last = position.len().checked_sub(JUMP_NEIGHBOURS)?;
    let jumps =
        (JUMP_NEIGHBOURS..last).map(|at| (at, ratio(&position, at).min(ratio(&command, at))));
    let found: Vec<(usize, f64)> = jumps.filter(|(_, ratio)| *ratio >= JUMP_RATIO).collect();
    let first = found.first()?;
    let lost: usize = found.iter().map(|(_, ratio)| ratio.round() as usize).sum();
    Some(RowFault {
        kind: RowFaultKind::Jump,
        episode,
        rows: lost,
        of: rows.len() + lost,
        first_s: Some(log.time_s[rows.start + first.0] - log.time_s[rows.start]),
    })
}

/// Runs of rows whose positions are those of the row before, between steps that are no smaller than usual: joints at rest repeat
/// their readings, too, but come to it slowly.
fn repeated(log: &EpisodeLog<'_>, episode: usize, scales: &Scales) -> Option<RowFault> {
    let rows = &log.episodes[episode];
    let position = log
        .joints
        .iter()
        .map(|joint| joint.position)
        .zip(scales.position.iter().copied());
    let steps = sizes(position, rows);
    let mut at = 0_usize;
    let mut found: Vec<(usize, usize)> = Vec::new();
    for run in steps.chunk_by(|a, b| (*a == 0.0) == (*b == 0.0)) {
        let moves = |at: Option<usize>| {
            at.and_then(|at| steps.get(at))
                .is_some_and(|step| *step >= REPEATED_STEP)
        };
        if run[0] == 0.0 && moves(at.checked_sub(1)) && moves(Some(at + run.len())) {
            found.push((at, run.len()));
        }
        at += run.len();
    }
    let count: usize = found.iter().map(|run| run.1).sum();
    (count as f64 >= REPEATED_SHARE * rows.len() as f64 && count > 0).then(|| RowFault {
        kind: RowFaultKind::Repeated,
        episode,
        rows: count,
        of: rows.len(),
        first_s: found
            .first()
            .map(|run| log.time_s[rows.start + run.0] - log.time_s[rows.start]),
    })
}
