//! What is read around readings that are none.

use std::ops::Range;

/// The readings around a row that stay.
pub(super) fn neighbours(
    column: &[f64],
    gone: &[usize],
    runs: &[Range<usize>],
    row: usize,
) -> Option<(usize, usize)> {
    let run = runs.iter().find(|run| run.contains(&row))?;
    let stays = |row: &usize| column[*row].is_finite() && gone.binary_search(row).is_err();
    let before = (run.start..row).rev().find(stays)?;
    let after = (row + 1..run.end).find(stays)?;
    Some((before, after))
}

/// The line between the readings around a row that stay, and how many rows they are apart.
pub(super) fn between(
    column: &[f64],
    gone: &[usize],
    runs: &[Range<usize>],
    row: usize,
) -> Option<(f64, usize)> {
    let (before, after) = neighbours(column, gone, runs, row)?;
    let share = (row - before) as f64 / (after - before) as f64;
    let value = column[before] + share * (column[after] - column[before]);
    Some((value, after - before - 1))
}
