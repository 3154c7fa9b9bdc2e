//! Runs of a recording, and the steps between its rows: of a motion or between postures.

use std::ops::Range;

use haptical_model::Recording;

/// Rows of one run each; a log without runs is one run.
pub(super) fn runs_of(recording: &Recording) -> Vec<Range<usize>> {
    let rows = recording.len();
    let mut runs = Vec::new();
    let mut start = 0;
    for row in 1..=rows {
        let ends = row == rows
            || recording
                .run
                .as_ref()
                .is_some_and(|run| run[row] != run[row - 1])
            || recording
                .time_s
                .as_ref()
                .is_some_and(|time_s| time_s[row] <= time_s[row - 1]);
        if ends {
            runs.push(start..row);
            start = row;
        }
    }
    runs
}

/// A step between rows of at most this share of a joint's range is one of a motion, not one between postures.
pub(super) const STEP_OF_A_MOTION: f64 = 0.05;
/// Fewer rows are taken as single postures.
const ROWS_OF_A_MOTION: usize = 64;

/// Samples on each side over which torques and forces are averaged at most, ...
const LOAD_REACH: usize = 4;
/// ... and how far the joints may move meanwhile, as a share of their range.
const LOAD_IS_STEADY: f64 = 0.04;

/// Samples on each side over which loads hardly change.
pub(super) fn load_reach(step: f64) -> usize {
    if step * LOAD_REACH as f64 <= LOAD_IS_STEADY {
        LOAD_REACH
    } else {
        (LOAD_IS_STEADY / step) as usize
    }
}

/// Motion between successive rows: the median step of the joint that moves most, over its range; none for
/// a few rows, or where nothing moves between rows.
pub(super) fn step_of_range(recording: &Recording, runs: &[Range<usize>]) -> Option<f64> {
    if recording.len() < ROWS_OF_A_MOTION {
        return None;
    }
    let mut largest: f64 = 0.0;
    for column in &recording.joint {
        let low = column.iter().copied().fold(f64::INFINITY, f64::min);
        let high = column.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if high <= low {
            continue;
        }
        let steps: Vec<f64> = runs
            .iter()
            .flat_map(|run| {
                (run.start + 1..run.end).map(|row| (column[row] - column[row - 1]).abs())
            })
            .collect();
        largest = largest.max(haptical_metrics::median(&steps).ok()? / (high - low));
    }
    Some(largest)
}
