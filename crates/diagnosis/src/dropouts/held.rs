//! Torques that repeat the reading before.

use std::f64::consts::PI;
use std::ops::Range;

use crate::noise::difference_sd;
use crate::thresholds::admission::{
    FILLED_ROWS, HELD_OVER_CHANCE, LEAST_HELD_SHARE, MOST_HELD_SHARE,
};

/// Rows at which a torque is exactly that of the row before while its joint moves; none where its steps are so coarse that it may be, and none
/// where it is written less often than the log has rows.
pub(super) fn held(column: &[f64], angles: &[f64], runs: &[Range<usize>]) -> Vec<usize> {
    let Some(sd) = difference_sd(column, runs).filter(|sd| *sd > 0.0) else {
        return Vec::new();
    };
    let is_held = |row: &usize| column[*row] == column[row - 1];
    let moves = |row: &usize| angles[*row] != angles[row - 1];
    let inside = runs.iter().flat_map(|run| run.clone().skip(1));
    let moving: Vec<usize> = inside.filter(moves).collect();
    let rows: Vec<usize> = moving.iter().copied().filter(is_held).collect();
    // two normal numbers that are rounded to a step are the same with this chance
    let chance = smallest_step(column) / (2.0 * PI.sqrt() * sd);
    let share = rows.len() as f64 / moving.len().max(1) as f64;
    if share < LEAST_HELD_SHARE + HELD_OVER_CHANCE * chance || share > MOST_HELD_SHARE {
        return Vec::new();
    }
    // a drive at its limit, or a sensor in its dead band, reads one value for longer
    let short = stretches(&rows).filter(|stretch| stretch.len() <= FILLED_ROWS);
    let short: Vec<usize> = short.flatten().collect();
    match 2 * short.len() > rows.len() {
        true => short,
        false => Vec::new(),
    }
}

/// Successive rows.
fn stretches(rows: &[usize]) -> impl Iterator<Item = Range<usize>> + '_ {
    rows.chunk_by(|before, row| before + 1 == *row)
        .map(|chunk| chunk[0]..chunk[chunk.len() - 1] + 1)
}

/// The smallest difference between two values that are read.
fn smallest_step(column: &[f64]) -> f64 {
    let mut values: Vec<f64> = column.iter().copied().filter(|v| v.is_finite()).collect();
    values.sort_unstable_by(f64::total_cmp);
    let steps = values.windows(2).map(|pair| pair[1] - pair[0]);
    steps
        .filter(|step| *step > 0.0)
        .fold(f64::INFINITY, f64::min)
}
