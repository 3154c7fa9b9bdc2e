//! Wild torques: far from what is read around them.

use std::ops::Range;

use super::neighbours::neighbours;
use crate::noise::{difference_sd, outliers};
use crate::thresholds::admission::{
    LEAST_SPIKE_SHARE, LEAST_WILD_MOMENTS, MOST_AT_LOW, MOST_WILD_PASSES, MOST_WILD_ROWS,
    SPIKE_OF_TORQUE, SPIKE_REACH, SPIKE_SDS, WILD_SDS,
};
use crate::thresholds::noise::MEDIAN_REACH;

/// Rows whose torque is far from the readings around it; none where these come where a gear knocks. Where there are such readings, smaller ones of
/// the same kind are among them.
pub(super) fn wild(column: &[f64], speeds: &[f64], runs: &[Range<usize>]) -> Vec<usize> {
    let Some(sd) = difference_sd(column, runs).filter(|sd| *sd > 0.0) else {
        return Vec::new();
    };
    // where friction changes sides a torque without noise has corners
    let limit = (SPIKE_SDS * sd).max(SPIKE_OF_TORQUE * spread(column));
    let rows = alone(column, runs, MEDIAN_REACH, (limit, 1.0));
    let load = |row: usize| {
        let around = neighbours(column, &rows, runs, row);
        around.map_or(f64::NAN, |(before, after)| {
            0.5 * (column[before] + column[after]).abs()
        })
    };
    let readings = column.iter().filter(|value| value.is_finite()).count();
    let are_some = rows.len() as f64 >= LEAST_SPIKE_SHARE * readings as f64;
    // knocks of a gear come where the load changes sides or the joint turns round: they are the arm's
    let is_of_arm = || {
        let loads: Vec<f64> = (0..column.len()).map(load).collect();
        are_low(&rows, speeds) || are_low(&rows, &loads)
    };
    if rows.is_empty() || !are_some || are_ringing(&rows) || is_of_arm() {
        return Vec::new();
    }
    // those behind others show once these are gone
    let mut left = column.to_vec();
    let mut all = Vec::new();
    for _ in 0..MOST_WILD_PASSES {
        let mut rows = alone(&left, runs, SPIKE_REACH, (WILD_SDS * sd, 0.0));
        if rows.is_empty() {
            // several moments next to each other hide from a median of few rows
            rows = alone(&left, runs, 2 * SPIKE_REACH, (limit, 0.0));
        }
        if rows.is_empty() {
            break;
        }
        rows.iter().for_each(|row| left[*row] = f64::NAN);
        all.extend(rows);
    }
    all.sort_unstable();
    all
}

/// Whether rows come at few places, or in long stretches with little between them, as where an arm rings: readings are wild for moments, all
/// over a log.
fn are_ringing(rows: &[usize]) -> bool {
    let moments = rows.chunk_by(|before, row| row - before <= 2 * SPIKE_REACH);
    let moments = moments.count();
    moments < LEAST_WILD_MOMENTS || rows.len() > MOST_WILD_ROWS * moments
}

/// Rows that are further than `limit` from the median of `reach` rows on either side and from what stays before and behind, on the same side,
/// and further than `of_step` times what these two are apart: a torque that goes on from another level has stepped there, as friction does where a joint turns
/// round.
fn alone(
    column: &[f64],
    runs: &[Range<usize>],
    reach: usize,
    (limit, of_step): (f64, f64),
) -> Vec<usize> {
    let far = outliers(column, runs, Some(reach), limit, &vec![0.0; column.len()]);
    let stands_alone = |row: &usize| {
        let around = neighbours(column, &far, runs, *row);
        around.is_some_and(|(before, after)| {
            let step = (column[before] - column[after]).abs();
            let [before, after] = [before, after].map(|item| column[*row] - column[item]);
            before.abs().min(after.abs()) > limit.max(of_step * step) && before * after > 0.0
        })
    };
    far.iter().copied().filter(stands_alone).collect()
}

/// Whether rows come where a quantity is low: most of them in its lowest fifth.
fn are_low(rows: &[usize], quantity: &[f64]) -> bool {
    let mut sorted: Vec<f64> = quantity
        .iter()
        .copied()
        .filter(|value| value.is_finite())
        .collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let Some(lowest) = sorted.get(sorted.len() / 5) else {
        return false;
    };
    let low = rows.iter().filter(|row| quantity[**row] < *lowest).count();
    low as f64 > MOST_AT_LOW * rows.len() as f64
}

/// Speed of a joint from row to row, without a sign and up to a factor.
pub(super) fn speeds(joint: &[f64], runs: &[Range<usize>]) -> Vec<f64> {
    let mut speeds = vec![f64::NAN; joint.len()];
    for run in runs.iter().filter(|run| run.len() > 2) {
        for row in run.start + 1..run.end - 1 {
            speeds[row] = (joint[row + 1] - joint[row - 1]).abs();
        }
    }
    speeds
}

/// Standard deviation of the readings.
fn spread(column: &[f64]) -> f64 {
    let read = || column.iter().filter(|value| value.is_finite());
    let count = read().count().max(1) as f64;
    let mean = read().sum::<f64>() / count;
    (read().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt()
}
