//! What is there from a run on: a displacement, another zero.

use super::Input;
use crate::Further;

/// From which run on a displacement is there: its number, from 1, in the order of the log.
pub(crate) const FROM_RUN: Further = Further::usually("from_run", 1.0);

/// The run of its number, from 0; the first one where the log has fewer: it was recorded later.
pub(crate) fn run_of(input: Input<'_, '_>, from_run: f64) -> f64 {
    let run = (from_run - 1.0).max(0.0);
    if (run as usize) < input.context.runs.len() {
        run
    } else {
        0.0
    }
}

/// First row of a run.
pub(crate) fn first_row(input: Input<'_, '_>, run: f64) -> usize {
    let run = input.context.runs.get(run as usize);
    run.map_or(usize::MAX, |run| run.start)
}
