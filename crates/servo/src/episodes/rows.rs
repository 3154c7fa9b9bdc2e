//! Rows that a recorder lost or wrote twice.

use std::ops::Range;

use super::EpisodeLog;
use super::series::{episode_step_s, step_s};
use crate::effect::recording;
use crate::thresholds::{
    FEWEST_LOST, JUMP_NEIGHBOURS, JUMP_RATIO, JUMP_REST, LOST_SHARE, LOST_STEPS, MISSING_SHARE,
    REPEATED_CHANCE, REPEATED_LEAST_S, REPEATED_SHARE, REPEATED_STEP, REPEATS_ALONE,
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
    /// Rows in which a joint has no reading.
    Missing,
}

impl RowFaultKind {
    /// Name of the effect.
    pub fn effect(self) -> &'static str {
        match self {
            Self::Lost | Self::Jump | Self::Short => recording::LOST,
            Self::Repeated => recording::REPEATED,
            Self::Missing => recording::MISSING,
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
        [lost, repeated(log, episode, &scales), missing(log, episode)]
    })
    .flatten()
    .collect()
}

fn lost(log: &EpisodeLog<'_>, episode: usize, step: f64) -> Option<RowFault> {
    let times = &log.time_s[log.episodes[episode].clone()];
    // an episode may have a rate of its own
    let usual = episode_step_s(log, episode);
    let step = if usual.is_finite() { usual } else { step };
    let gaps = times.windows(2).map(|pair| [pair[0], pair[1] - pair[0]]);
    let gaps: Vec<[f64; 2]> = gaps.filter(|gap| gap[1] > LOST_STEPS * step).collect();
    let first = gaps.first()?;
    let lost = gaps
        .iter()
        .map(|gap| ((gap[1] / step).round() as usize).saturating_sub(1));
    let (rows, most) = (lost.clone().sum::<usize>(), lost.max()?);
    // a row now and then is what every recorder loses
    if most < FEWEST_LOST && (rows as f64) < LOST_SHARE * times.len() as f64 {
        return None;
    }
    Some(RowFault {
        kind: RowFaultKind::Lost,
        episode,
        rows,
        of: times.len() + rows,
        first_s: Some(first[0] - times[0]),
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

/// Sizes of the steps before each row but the first, root mean square over the columns that move, in usual steps.
fn sizes<'a>(columns: impl Iterator<Item = (&'a [f64], f64)>, rows: &Range<usize>) -> Vec<f64> {
    let mut squares = vec![0.0; rows.len().saturating_sub(1)];
    let columns: Vec<(&[f64], f64)> = columns.filter(|(_, scale)| *scale > 0.0).collect();
    let count = columns.len().max(1) as f64;
    for (column, scale) in columns {
        for (square, pair) in squares.iter_mut().zip(column[rows.clone()].windows(2)) {
            let step = (pair[1] - pair[0]) / scale;
            *square += if step.is_finite() { step * step } else { 0.0 };
        }
    }
    squares
        .into_iter()
        .map(|square| (square / count).sqrt())
        .collect()
}

/// The same of the positions.
fn position_sizes(log: &EpisodeLog<'_>, rows: &Range<usize>, scales: &Scales) -> Vec<f64> {
    let columns = log.joints.iter().map(|joint| joint.position);
    sizes(columns.zip(scales.position.iter().copied()), rows)
}

fn jump(log: &EpisodeLog<'_>, episode: usize, scales: &Scales) -> Option<RowFault> {
    let rows = &log.episodes[episode];
    let command = log.joints.iter().zip(&scales.command);
    let command = command.filter_map(|(joint, scale)| Some((joint.command?, *scale)));
    let (position, command) = (position_sizes(log, rows, scales), sizes(command, rows));
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
    let is_jump =
        |(at, ratio): &(usize, f64)| *ratio >= JUMP_RATIO && jumps_together(log, rows, *at, scales);
    let found: Vec<(usize, f64)> = jumps.filter(is_jump).collect();
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

/// Whether most joints that move jump at a row: one of a hand that opens at once does so alone.
fn jumps_together(log: &EpisodeLog<'_>, rows: &Range<usize>, at: usize, scales: &Scales) -> bool {
    let (mut moving, mut jumping) = (0, 0);
    for (joint, scale) in log.joints.iter().zip(&scales.position) {
        let step = |at: usize| {
            (joint.position[rows.start + at + 1] - joint.position[rows.start + at]).abs() / scale
        };
        let near = (at - JUMP_NEIGHBOURS..=at + JUMP_NEIGHBOURS).filter(|other| *other != at);
        let most = near.map(step).fold(0.0, f64::max);
        let size = step(at);
        moving += usize::from(size.max(most) >= JUMP_REST);
        jumping += usize::from(size >= JUMP_RATIO * most.max(JUMP_REST));
    }
    2 * jumping >= moving && jumping >= 2.min(log.joints.len())
}

/// Runs of rows whose positions are those of the row before, between steps that are no smaller than usual: joints at rest repeat
/// their readings, too, but come to it slowly.
fn repeated(log: &EpisodeLog<'_>, episode: usize, scales: &Scales) -> Option<RowFault> {
    if episode_step_s(log, episode) < REPEATED_LEAST_S {
        return None;
    }
    let rows = &log.episodes[episode];
    let steps = position_sizes(log, rows, scales);
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
    let alone = shares(log, rows, &steps);
    // a joint that reads something new in most rows tells
    if alone.iter().copied().fold(f64::INFINITY, f64::min) > REPEATS_ALONE {
        return None;
    }
    if (count as f64) < REPEATED_CHANCE * steps.len() as f64 * alone.iter().product::<f64>() {
        return None;
    }
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

/// Share of the readings that each joint repeats by itself: in the rows in which another one does not.
fn shares(log: &EpisodeLog<'_>, rows: &Range<usize>, steps: &[f64]) -> Vec<f64> {
    let others: Vec<usize> = (0..steps.len()).filter(|at| steps[*at] > 0.0).collect();
    let share = |column: &[f64]| {
        let equal = others
            .iter()
            .filter(|at| column[rows.start + *at + 1] == column[rows.start + *at]);
        equal.count() as f64 / others.len().max(1) as f64
    };
    log.joints
        .iter()
        .map(|joint| share(joint.position))
        .collect()
}

/// Readings of a joint that are missing.
fn missing(log: &EpisodeLog<'_>, episode: usize) -> Option<RowFault> {
    let rows = &log.episodes[episode];
    let of = |joint: &super::JointColumns<'_>| {
        rows.clone()
            .filter(|row| !joint.position[*row].is_finite())
            .count()
    };
    let most = log.joints.iter().map(of).max()?;
    (most as f64 > MISSING_SHARE * rows.len() as f64).then(|| RowFault {
        kind: RowFaultKind::Missing,
        episode,
        rows: most,
        of: rows.len(),
        first_s: None,
    })
}
