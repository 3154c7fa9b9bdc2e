//! Moments at which a channel reads one value.

use std::ops::Range;

use haptical_metrics::median;

use crate::noise::difference_sd;
use crate::thresholds::admission::{
    DROPOUT_SDS, LEAST_DROPOUT_LEVEL, LEAST_DROPOUT_SHARE, LEAST_DROPOUTS, LONGEST_DROPOUT_ROWS,
};

/// Rows at which a column reads one value for moments, and the value; none where there are none.
pub(super) fn moments(column: &[f64], runs: &[Range<usize>]) -> Option<(Vec<usize>, f64)> {
    let value = most_frequent(column)?;
    let rows = moments_at(column, runs, value);
    let readings = column.iter().filter(|value| value.is_finite()).count();
    let are_many = rows.len() as f64 >= LEAST_DROPOUT_SHARE * readings as f64;
    (are_many && !rows.is_empty()).then_some((rows, value))
}

/// The value that most readings share.
fn most_frequent(column: &[f64]) -> Option<f64> {
    let finite = column.iter().filter(|value| value.is_finite());
    // a zero has two signs
    let mut bits: Vec<u64> = finite.map(|value| (value + 0.0).to_bits()).collect();
    bits.sort_unstable();
    let most = bits.chunk_by(|a, b| a == b).max_by_key(|same| same.len())?;
    (most.len() >= LEAST_DROPOUTS).then(|| f64::from_bits(most[0]))
}

/// Rows that read a value for a moment. None where these moments come where the channel is about that value anyway: then it is one that
/// the channel may have, as in the dead band of a sensor. Moments come whatever the channel reads.
fn moments_at(column: &[f64], runs: &[Range<usize>], value: f64) -> Vec<usize> {
    let is_it = |row: usize| column[row] == value;
    let others: Vec<f64> = (column.iter())
        .map(|item| if *item == value { f64::NAN } else { *item })
        .collect();
    let Some(sd) = difference_sd(&others, runs).filter(|sd| *sd > 0.0) else {
        return Vec::new();
    };
    let is_far = |item: f64| (item - value).abs() > DROPOUT_SDS * sd;
    let (mut rows, mut levels, mut plain) = (Vec::new(), Vec::new(), 0);
    for run in runs {
        let mut row = run.start;
        while row < run.end {
            let first = row;
            while row < run.end && is_it(row) {
                row += 1;
            }
            let is_inside = row > first && first > run.start && row < run.end;
            if is_inside && row - first <= LONGEST_DROPOUT_ROWS {
                let is_plain = is_far(column[first - 1]) && is_far(column[row]);
                plain += if is_plain { row - first } else { 0 };
                levels.push((0.5 * (column[first - 1] + column[row]) - value).abs());
                rows.extend(first..row);
            }
            row = row.max(first + 1);
        }
    }
    let read: Vec<f64> = (others.iter().filter(|item| item.is_finite()))
        .map(|item| (item - value).abs())
        .collect();
    let is_anywhere = match (median(&levels), median(&read)) {
        (Ok(level), Ok(usual)) => level > LEAST_DROPOUT_LEVEL * usual,
        _ => false,
    };
    match plain >= LEAST_DROPOUTS && is_anywhere {
        true => rows,
        false => Vec::new(),
    }
}
