//! A position that ends at one value while its command goes beyond.

use std::ops::Range;

use super::scale::median;
use super::series::Joint;
use super::{EpisodeFinding, Fault};
use crate::thresholds::{
    CLIPPED_EPISODES, CLIPPED_HELD, CLIPPED_ROWS, CLIPPED_SCATTERS, FOLLOWING_REPEATS,
};

/// Upper and lower ends.
pub(super) fn faults(joint: &Joint, least: f64) -> Vec<EpisodeFinding> {
    let levels = joint.levels();
    let level = median(&mut levels.clone());
    let repeats = joint.repeated();
    let ends = [true, false].into_iter();
    ends.filter_map(|is_upper| {
        let sign = if is_upper { 1.0 } else { -1.0 };
        at_one_end(joint, sign, sign * level, repeats, least)
    })
    .collect()
}

/// The end of an episode's positions: the value, and how many rows read it.
#[derive(Debug, Clone, Copy)]
struct End {
    value: f64,
    rows: usize,
    /// Whether others read less.
    moves: bool,
}

fn at_one_end(
    joint: &Joint,
    sign: f64,
    level: f64,
    repeats: f64,
    least: f64,
) -> Option<EpisodeFinding> {
    let position = |row: usize| sign * joint.position[row];
    let ends: Vec<End> = (joint.episodes.iter())
        .map(|(_, rows)| {
            let value = joint
                .rows(rows)
                .map(position)
                .fold(f64::NEG_INFINITY, f64::max);
            let at_end = joint
                .rows(rows)
                .filter(|row| position(*row) == value)
                .count();
            End {
                value,
                rows: at_end,
                moves: at_end < joint.rows(rows).count(),
            }
        })
        .collect();
    let value = common(&ends)?;
    let is_at = |place: usize| ends[place].value == value && ends[place].rows >= CLIPPED_ROWS;
    let shows = (0..ends.len()).find(|place| is_at(*place))?;
    // the end may take a row or two in the episodes just before
    let first = (0..shows)
        .rev()
        .take_while(|place| ends[*place].value == value)
        .last()
        .unwrap_or(shows);
    // an episode that goes beyond ends the stretch
    let last = (first..ends.len())
        .take_while(|place| ends[*place].value <= value)
        .last()?;
    let (mut at_end, mut all, mut beyond, mut usual, mut held) = (0, 0, Vec::new(), Vec::new(), 0);
    for (_, rows) in &joint.episodes[first..=last] {
        for row in joint.rows(rows) {
            all += 1;
            let excess = sign * joint.command[row] + level - position(row);
            if position(row) == value {
                at_end += 1;
                beyond.push(excess);
            } else {
                usual.push(excess.abs());
            }
        }
        held += usize::from(moves_at(joint, rows, sign * value) >= least);
    }
    let usual = median(&mut usual);
    let far = beyond.iter().copied().fold(0.0, f64::max);
    let goes_beyond = far >= (CLIPPED_SCATTERS * usual).max(least) && median(&mut beyond) > usual;
    // a sensor that changes with each row is at one value by no chance; a finger that holds something is, at any value
    let stays = repeats < FOLLOWING_REPEATS && held >= CLIPPED_HELD && far >= least;
    (goes_beyond || stays).then(|| EpisodeFinding {
        fault: Fault::Clipped {
            at: sign * value,
            is_upper: sign > 0.0,
            share: f64::from(at_end) / f64::from(all),
        },
        since: joint.episodes[first].0,
        until: (last + 1 < ends.len()).then(|| joint.episodes[last].0),
        probability: 0.99,
    })
}

/// The end that most episodes share.
fn common(ends: &[End]) -> Option<f64> {
    let often = ends
        .iter()
        .filter(|end| end.moves && end.rows >= CLIPPED_ROWS);
    let mut often: Vec<f64> = often.map(|end| end.value).collect();
    often.sort_by(f64::total_cmp);
    let runs = often.chunk_by(|a, b| a == b);
    let most = runs.max_by_key(|run| run.len())?;
    (most.len() >= CLIPPED_EPISODES).then(|| most[0])
}

/// The farthest that the command moves while the position stays at a value.
fn moves_at(joint: &Joint, rows: &Range<usize>, value: f64) -> f64 {
    let commands = &joint.command[rows.clone()];
    let pairs: Vec<(f64, f64)> = joint.position[rows.clone()]
        .iter()
        .copied()
        .zip(commands.iter().copied())
        .collect();
    let runs = pairs.chunk_by(|a, b| (a.0 == value) == (b.0 == value));
    let range = |run: &[(f64, f64)]| {
        let ends = run.iter().fold(
            (f64::INFINITY, f64::NEG_INFINITY),
            |(least, most), (_, command)| (least.min(*command), most.max(*command)),
        );
        ends.1 - ends.0
    };
    let at_value = runs.filter(|run| run[0].0 == value && run.len() >= CLIPPED_ROWS);
    at_value.map(range).fold(0.0, f64::max)
}
