//! What the base model, and the effects beside it, leave of rows that they were not fitted to.

use std::rc::Rc;

use crate::fit::base::Base;
use crate::fit::column::Column;
use crate::fit::problem::Problem;
use crate::fit::system::System;
use crate::select::Selection;

/// Parts in time that sums are kept of.
pub const PARTS: usize = 10;
/// Fits, each without every fifth part.
pub(crate) const FOLDS: usize = 5;

/// One joint's torque on rows that were not fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Unseen {
    /// Joint, from 0.
    pub joint: usize,
    /// Noise of a row, in the torque's unit.
    pub noise: f64,
    /// Rows of each part in time.
    pub rows: [usize; PARTS],
    /// Sums of squares that the base model leaves in each part, in the torque's unit.
    pub before: [f64; PARTS],
    /// With the effects.
    pub after: [f64; PARTS],
    /// Row of the recording, what was measured, and both predictions, row by row; empty where the rows are of the recording that was
    /// fitted.
    pub predictions: Vec<(usize, [f64; 3])>,
    /// Of a second recording: root mean square over the noise of what one fit of both leaves, of the first one and of this one. None where
    /// no such fit was made.
    pub of_both: Option<[f64; 2]>,
}

impl Unseen {
    /// Rows of all parts.
    pub fn rows_in_all(&self) -> usize {
        self.rows.iter().sum()
    }
}

/// Rows of a recording that are left out in turn; nothing where no effect was taken.
pub(crate) fn within(problem: &Problem, base: &Base, selection: &Selection) -> Vec<Unseen> {
    if selection.picks.is_empty() {
        return Vec::new();
    }
    let rows = problem.states.rows();
    let effects: Vec<Rc<Column>> = (selection.picks.iter())
        .flat_map(|own| own.columns.iter().cloned())
        .collect();
    let part = |row: usize| row * PARTS / rows;
    let mut rests = [Vec::new(), Vec::new()];
    for (rest, (fitted, columns, early_s)) in rests.iter_mut().zip([
        (&selection.bare, [].as_slice(), 0.0),
        (&selection.fitted, effects.as_slice(), selection.early_s),
    ]) {
        let recorded = problem.recorded(early_s);
        *rest = vec![0.0; recorded.len()];
        let all: Vec<Rc<Column>> = (base.columns.iter().map(|own| &own.column))
            .chain(columns)
            .cloned()
            .collect();
        let known: Vec<Option<f64>> = base.columns.iter().map(|own| own.known_sd).collect();
        for fold in 0..FOLDS {
            let is_held = |row: usize| part(row) % FOLDS == fold;
            let kept: Vec<Rc<Column>> = all
                .iter()
                .map(|own| Rc::new(own.masked(|k| !is_held(k % rows))))
                .collect();
            let solved = System::new(&kept, &known).solve(&recorded, &fitted.fixed);
            let mut left = recorded.clone();
            for (column, value) in all.iter().zip(&solved.solution) {
                column.add_to(&mut left, -value);
            }
            for (k, value) in left
                .into_iter()
                .enumerate()
                .filter(|(k, _)| is_held(k % rows))
            {
                rest[k] = value;
            }
        }
    }
    collected(problem, &rests)
}

/// Sums of squares of both rests, channel by channel and part by part.
pub(crate) fn collected(problem: &Problem, rests: &[Vec<f64>; 2]) -> Vec<Unseen> {
    let rows = problem.states.rows();
    let of_channel = |(channel, &joint): (usize, &usize)| {
        let noise = problem.row_sd[channel];
        let mut found = Unseen {
            joint,
            noise,
            rows: [0; PARTS],
            before: [0.0; PARTS],
            after: [0.0; PARTS],
            predictions: Vec::new(),
            of_both: None,
        };
        for row in 0..rows {
            let part = row * PARTS / rows;
            let square = |rest: &[f64]| (noise * rest[channel * rows + row]).powi(2);
            found.rows[part] += 1;
            found.before[part] += square(&rests[0]);
            found.after[part] += square(&rests[1]);
        }
        found
    };
    problem
        .channels
        .iter()
        .enumerate()
        .map(of_channel)
        .collect()
}
