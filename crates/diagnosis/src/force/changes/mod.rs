//! What the arm carries in some runs and not in others: a payload that was put on, changed or put down between two runs.
//!
//! docs/diagnosis-force.md, "Payload", derives the test. It asks for the change alone: whatever the base model lacks in both
//! runs alike (friction, springs, cables) is a function of the state that both share.

mod columns;
mod folds;
mod gain;
mod hypothesis;
mod judge;
mod size;

use std::ops::Range;

use haptical_effects::force::PAYLOAD;

pub(super) use self::columns::Columns;
pub(super) use self::columns::Pair;
pub(super) use self::folds::{Fitted, Folds};
pub(super) use self::gain::is_beyond_choice;
pub(super) use self::judge::Payload;
use super::Means;
use super::along::Along;
use super::base::Base;
use crate::answer::CauseAnswer;
use crate::select::excess;
use crate::thresholds::payload::{LEAST_BLOCKS, MOST_RUNS};

/// What the arm carries in some runs and not in others. The model takes its torques off the readings.
#[derive(Debug)]
pub(super) struct Carried {
    /// Payloads that were put on or down, in the order of the runs.
    pub(super) payloads: Vec<Payload>,
    /// Why no payload was looked for, or not after some run.
    pub(super) not_tested: Option<String>,
    /// Block means by the base model with no payload taken off, and what it leaves of them.
    pub(super) fitted_before: Means,
    pub(super) rest_before: Means,
    /// Structured energy of what is left.
    energy: f64,
    /// Torque of all payloads together.
    pub(super) torque_nm: Means,
}

impl Carried {
    /// Looks for payloads, unless their name is left out of the catalogue.
    pub(super) fn new(along: &Along<'_>, base: &Base, without: &[String]) -> Self {
        let rest = base.rest();
        let free = along.recorded.free_directions();
        let mut carried = Self {
            payloads: Vec::new(),
            not_tested: None,
            fitted_before: &along.reading - &rest,
            torque_nm: rest.map(|_| 0.0),
            rest_before: rest,
            energy: excess(&base.energy(free)).0.max(0.0),
        };
        if !without.iter().any(|name| name == PAYLOAD.name) {
            carried.not_tested = carried.look(along, base).err();
        }
        for payload in &carried.payloads {
            carried.torque_nm += &payload.torque_nm;
        }
        carried
    }

    /// Compares every run with those before it, back to the last change. The error says why some were not compared.
    fn look(&mut self, along: &Along<'_>, base: &Base) -> Result<(), String> {
        let recorded = &along.recorded;
        if recorded.is_held {
            let why = "no columns fx_n, fy_n, fz_n: nobody knows what of a weight the hand carries";
            return Err(why.to_owned());
        }
        let runs = runs_of_blocks(along);
        if runs.len() < 2 {
            return Err("one run only: masses that all rows share are fitted".to_owned());
        }
        if recorded.channels.len() < 2 {
            return Err("one torque alone: a payload shows on several joints".to_owned());
        }
        let mut is_whole = true;
        let mut before = runs[0].clone();
        for (run, after) in runs.iter().enumerate().skip(1) {
            if run > MOST_RUNS {
                return Err(format!("runs after number {run} were not compared"));
            }
            let is_long = before.len() >= LEAST_BLOCKS && after.len() >= LEAST_BLOCKS;
            is_whole &= is_long;
            let pair = is_long.then(|| Pair::new(along, before.clone(), after.clone()));
            match pair.and_then(|pair| judge::payload(along, base, &pair, run)) {
                Some(found) => {
                    self.payloads.push(found);
                    before = after.clone();
                }
                None => before = before.start..after.end,
            }
        }
        match is_whole {
            true => Ok(()),
            false => Err("a run is too short to be compared".to_owned()),
        }
    }

    /// Share of the gap that the payloads leave for other effects. `left` is its structured energy, `total` the
    /// squares that other effects are to explain.
    pub(super) fn rest_share(&self, left: f64, total: f64) -> f64 {
        if self.payloads.is_empty() {
            return 1.0;
        }
        let closed = (self.energy - left.max(0.0)).max(0.0);
        total / (total + closed).max(1e-300)
    }

    /// Share of the squares beyond noise that a payload closes on unseen blocks, the least of all payloads.
    pub(super) fn closed_share(&self) -> Option<f64> {
        let shares = self.payloads.iter().map(|payload| payload.closed_share);
        shares.reduce(f64::min)
    }

    /// The payloads as findings, largest first.
    pub(super) fn findings(&self, rest_share: f64) -> Vec<CauseAnswer> {
        let square = |payload: &Payload| payload.torque_nm.norm_squared();
        let all: f64 = self.payloads.iter().map(square).sum();
        let closed = 1.0 - rest_share;
        let share = |payload: &Payload| closed * square(payload) / all.max(1e-300);
        let found = self.payloads.iter().map(|payload| CauseAnswer {
            share: share(payload),
            ..payload.cause.clone()
        });
        let mut found: Vec<CauseAnswer> = found.collect();
        found.sort_by(|a, b| b.share.total_cmp(&a.share));
        found
    }
}

/// Blocks of each run that has any, in order.
fn runs_of_blocks(along: &Along<'_>) -> Vec<Range<usize>> {
    let blocks = &along.recorded.blocks;
    let before = |row: usize| blocks.partition_point(|block| block.rows.start < row);
    let runs = along.recorded.context.runs.iter();
    runs.map(|run| before(run.start)..before(run.end)).collect()
}
