//! What the base model, and the effects beside it, leave of rows that they were not fitted to.

use std::rc::Rc;

use crate::effect::ends_at;
use crate::examined::gap;
use crate::fit::base::Base;
use crate::fit::column::Column;
use crate::fit::problem::Problem;
use crate::fit::system::System;
use crate::select::Selection;
use crate::thresholds::examine::{FOLDS, LEAST_PART, PARTS};

/// One joint's torque on rows that were not fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Unseen {
    /// Joint, from 0.
    pub joint: usize,
    /// Noise of a row, in the torque's unit.
    pub noise: f64,
    /// Rows that are not predicted and in nothing else of this, as the fit does not determine them (A245), and the sum of squares that
    /// the base model leaves in them where it is fitted to all rows.
    pub left_out: (usize, f64),
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
    /// Mean variance of the predictions by the error of the fit, over that of noise; 0 where it is not known.
    pub error_of_fit: f64,
}

impl Unseen {
    /// Of no rows yet.
    pub fn new(joint: usize, noise: f64) -> Self {
        Self {
            joint,
            noise,
            left_out: (0, 0.0),
            rows: [0; PARTS],
            before: [0.0; PARTS],
            after: [0.0; PARTS],
            predictions: Vec::new(),
            of_both: None,
            error_of_fit: 0.0,
        }
    }

    /// Counts a row that is not predicted, by the squares that the base model leaves in it.
    pub fn leave_out(&mut self, before: f64) {
        self.left_out.0 += 1;
        self.left_out.1 += before;
    }

    /// Counts a row, of so many, by the squares that are left of it.
    pub fn add(&mut self, (row, count): (usize, usize), [before, after]: [f64; 2]) {
        let part = row * PARTS / count;
        self.rows[part] += 1;
        self.before[part] += before;
        self.after[part] += after;
    }

    /// Rows of all parts.
    pub fn rows_in_all(&self) -> usize {
        self.rows.iter().sum()
    }

    /// Sum of the squares beyond noise, in those of noise.
    fn beyond(&self, sums: &[f64; PARTS]) -> f64 {
        let of_noise = sums.iter().sum::<f64>() / self.noise.powi(2);
        (of_noise - self.rows_in_all() as f64).max(0.0)
    }

    /// Sum of the squares beyond noise that the base model leaves, in those of noise.
    pub(crate) fn beyond_before(&self) -> f64 {
        self.beyond(&self.before)
    }

    /// The same with the effects.
    pub(crate) fn beyond_after(&self) -> f64 {
        self.beyond(&self.after)
    }

    /// Whether the base model leaves more than noise.
    pub(crate) fn has_gap(&self) -> bool {
        self.is_gap(self.beyond_before())
    }

    fn is_gap(&self, beyond: f64) -> bool {
        let rows = self.rows_in_all();
        rows > 0 && beyond / rows as f64 > gap(rows)
    }

    /// Whether the effects make a gap where the base model leaves none.
    pub(crate) fn gets_gap(&self) -> bool {
        !self.has_gap() && self.is_gap(self.beyond_after())
    }

    /// Whether the effects take a part that counts of a gap, or make none where there is none.
    pub(crate) fn loses(&self) -> bool {
        let after = self.beyond_after();
        match self.has_gap() {
            true => after <= (1.0 - LEAST_PART).powi(2) * self.beyond_before(),
            false => !self.gets_gap(),
        }
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
    // what readings lack where they end is of their own rows; others of which the model is beyond the end end there as well
    let is_lacking: Vec<bool> = (selection.picks.iter())
        .flat_map(|own| own.columns.iter().map(|_| ends_at(own).is_some()))
        .collect();
    let part = |row: usize| row * PARTS / rows;
    let mut rests = [Vec::new(), Vec::new()];
    let mut is_predicted = vec![true; problem.channel_rows()];
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
        let is_own = |index: usize| {
            let effect = index.checked_sub(base.columns.len());
            effect.is_some_and(|effect| is_lacking[effect])
        };
        let known: Vec<Option<f64>> = base.columns.iter().map(|own| own.known_sd).collect();
        for fold in 0..FOLDS {
            let is_held = |row: usize| part(row) % FOLDS == fold;
            let kept: Vec<Rc<Column>> = all
                .iter()
                .map(|own| Rc::new(own.masked(|k| !is_held(k % rows))))
                .collect();
            let system = System::new(&kept, &known);
            let solved = system.solve(&recorded, &fitted.fixed);
            let columns: Vec<Option<Rc<Column>>> = (all.iter().enumerate())
                .map(|(index, own)| (!is_own(index)).then(|| own.clone()))
                .collect();
            let mut left = recorded.clone();
            for (column, value) in columns.iter().zip(&solved.solution) {
                if let Some(column) = column {
                    column.add_to(&mut left, -value);
                }
            }
            if !columns.iter().all(Option::is_some) {
                for (joint, limit_nm) in selection.picks.iter().filter_map(ends_at) {
                    end(problem, &mut left, (joint, limit_nm));
                }
            }
            for (k, value) in left
                .into_iter()
                .enumerate()
                .filter(|(k, _)| is_held(k % rows))
            {
                rest[k] = value;
                is_predicted[k] &= solved.determines(&columns, k);
            }
        }
    }
    selection.put_in_readings(problem, &mut rests[1]);
    collected(
        problem,
        &rests,
        (&is_predicted, Some(&selection.bare.solved.rest)),
    )
}

/// What is left where a joint's readings end at a torque.
pub(crate) fn end(problem: &Problem, rest: &mut [f64], (joint, limit_nm): (usize, f64)) {
    let rows = problem.states.rows();
    let Some(channel) = problem.channel_of(joint) else {
        return;
    };
    let torque = problem.states.torque(&problem.samples, joint, 0.0);
    for (row, reading) in torque.into_iter().enumerate() {
        let k = channel * rows + row;
        let model = reading - rest[k] / problem.weight(k);
        rest[k] = (reading - model.clamp(-limit_nm, limit_nm)) * problem.weight(k);
    }
}

/// Sums of squares of both rests, channel by channel and part by part, of the rows that are predicted; of the others those of `seen`,
/// what is left of them where they are fitted, if they are.
pub(crate) fn collected(
    problem: &Problem,
    rests: &[Vec<f64>; 2],
    (is_predicted, seen): (&[bool], Option<&[f64]>),
) -> Vec<Unseen> {
    let rows = problem.states.rows();
    let of_channel = |(channel, &joint): (usize, &usize)| {
        let noise = problem.row_sd[channel];
        let mut found = Unseen::new(joint, noise);
        for row in 0..rows {
            let k = channel * rows + row;
            let square = |rest: &[f64]| (noise * rest[k]).powi(2);
            if !is_predicted[k] {
                found.left_out.0 += 1;
                found.left_out.1 += seen.map_or(0.0, square);
                continue;
            }
            found.add((row, rows), [square(&rests[0]), square(&rests[1])]);
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
