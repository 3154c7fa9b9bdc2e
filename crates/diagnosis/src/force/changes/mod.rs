//! What the arm carries in some runs and not in others: a payload that was put on, changed or put down between two runs.
//!
//! docs/diagnosis-force.md, "Payload", derives the test. It asks for the change alone: whatever the base model lacks in both
//! runs alike (friction, springs, cables) is a function of the state that both share.

mod blocks;
pub(super) mod carried;
mod columns;
mod folds;
mod gain;
mod hypothesis;
mod judge;
pub(super) mod second;
mod size;

use std::ops::Range;

pub(super) use self::blocks::Pair;
pub(super) use self::columns::{Column, Columns, only};
pub(super) use self::folds::{Fitted, Folds};
pub(super) use self::gain::is_beyond_choice;
pub(super) use self::judge::{Payload, UnseenBlocks};
use super::along::Along;
use super::base::Base;
pub(super) use crate::thresholds::payload::FOLDS;
use crate::thresholds::payload::{LEAST_BLOCKS, MOST_RUNS};

/// What changed from run to run.
#[derive(Debug, Default)]
pub(super) struct Changes {
    /// Payloads that were put on or down, in the order of the runs.
    pub(super) payloads: Vec<Payload>,
    /// Why no payload was looked for, or not after some run.
    pub(super) not_tested: Option<String>,
}

/// Looks for payloads: every run against those before it, back to the last change.
pub(super) fn changes(along: &Along<'_>, base: &Base) -> Changes {
    let recorded = along.recorded;
    let mut changes = Changes::default();
    if recorded.hand_is_unknown() {
        let why = "no columns fx_n, fy_n, fz_n: nobody knows what of a weight the hand carries";
        changes.not_tested = Some(why.to_owned());
        return changes;
    }
    let runs: Vec<Range<usize>> = runs_of_blocks(along);
    if runs.len() < 2 {
        changes.not_tested = Some("one run only: masses that all rows share are fitted".to_owned());
        return changes;
    }
    if recorded.channels.len() < 2 {
        let why = "one torque alone: a payload shows on several joints";
        changes.not_tested = Some(why.to_owned());
        return changes;
    }
    let mut before = runs[0].clone();
    for (run, after) in runs.iter().enumerate().skip(1) {
        if run > MOST_RUNS {
            changes.not_tested = Some(format!("runs after number {run} were not compared"));
            break;
        }
        if before.len() < LEAST_BLOCKS || after.len() < LEAST_BLOCKS {
            changes.not_tested = Some("a run is too short to be compared".to_owned());
            before = before.start..after.end;
            continue;
        }
        let pair = Pair::new(along, before.clone(), after.clone());
        match judge::payload(along, base, &pair, run) {
            Some(found) => {
                changes.payloads.push(found);
                before = after.clone();
            }
            None => before = before.start..after.end,
        }
    }
    changes
}

/// Blocks of each run that has any, in order.
fn runs_of_blocks(along: &Along<'_>) -> Vec<Range<usize>> {
    let recorded = along.recorded;
    let mut first = 0;
    let own = recorded.context.runs.iter().map(|run| {
        let rest = &recorded.blocks[first..];
        let count = rest.iter().take_while(|block| block.rows.start < run.end);
        let range = first..first + count.count();
        first = range.end;
        range
    });
    own.collect()
}

/// One kilogram at the flange in all blocks, by the links' columns.
#[cfg(test)]
pub(super) fn at_flange(along: &Along<'_>) -> Vec<f64> {
    columns::of_last_link(along, &columns::flange(&along.flange_m())[0])
}
