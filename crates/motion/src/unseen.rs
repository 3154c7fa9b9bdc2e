//! What the base model, and the effects beside it, leave of rows that they were not fitted to.

use std::rc::Rc;

use haptical_model::Recording;

use crate::MotionError;
use crate::arm::Arm;
use crate::effect::{Candidate, Context, Finer, effect_names};
use crate::fit::base::Base;
use crate::fit::column::Column;
use crate::fit::problem::{Problem, Reading};
use crate::fit::system::System;
use crate::select::{Fitted, Frame, Pick, Pool, Selection};

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

/// Rows of a second recording. Effects that belong to the first one alone, as a contact does, are left out.
///
/// # Errors
/// [`MotionError`] for a recording that says nothing of a moving arm, or not of the same joints.
pub(crate) fn on_second(
    arm: &Arm,
    second: &Recording,
    first: (&Problem, &Base, &Selection),
) -> Result<Vec<Unseen>, MotionError> {
    let (own, base, selection) = first;
    let mut problem = Problem::new(
        arm.clone(),
        second,
        Reading {
            edge_hz: Some(own.states.pass.edge_hz),
            sets_right: true,
            has_memory: own.has_memory,
            ..Reading::default()
        },
    )?;
    problem.allow_for_rest(&base.coulomb, &base.turnovers());
    let there = Base::new(&problem, Some(&base.reversals));
    if there.columns.len() != base.columns.len() || problem.channels != own.channels {
        let message = "the second recording moves other joints, or lacks torques of some";
        return Err(MotionError::Sampling(message.to_owned()));
    }
    let frame = Frame::new(&problem, &there);
    let torque = there.torque(&problem, &selection.bare.solved.solution);
    let context = Context {
        problem: &problem,
        base: &there,
        torque: &torque,
    };
    let left = |fitted: &Fitted, early_s: f64| {
        let mut rest = problem.recorded(early_s);
        for (column, value) in there.columns.iter().zip(&fitted.solved.solution) {
            column.column.add_to(&mut rest, -value);
        }
        rest
    };
    let before = left(&selection.bare, 0.0);
    let mut after = left(&selection.fitted, selection.early_s);
    // of the picks' effects alone
    let is_there = |name: &str| selection.picks.iter().any(|own| own.effect == name);
    let others: Vec<String> = (effect_names().into_iter())
        .filter(|name| !is_there(name))
        .map(str::to_owned)
        .collect();
    let pool = Pool::new(context, &others);
    for pick in &selection.picks {
        let Some(candidate) = again(&pool, &frame, pick) else {
            continue;
        };
        for (column, value) in candidate.columns.iter().zip(&pick.coefficients) {
            column.add_to(&mut after, -value);
        }
    }
    let mut found = collected(&problem, &[before.clone(), after.clone()]);
    let rows = problem.states.rows();
    for (channel, unseen) in found.iter_mut().enumerate() {
        let torque = problem.states.torque(&problem.samples, unseen.joint, 0.0);
        let at = |row: usize| {
            let k = channel * rows + row;
            let [before, after] =
                [&before, &after].map(|rest| torque[row] - rest[k] / problem.weight(k));
            (
                problem.states.row_of[problem.states.centre[row]],
                [torque[row], before, after],
            )
        };
        unseen.predictions = (0..rows).map(at).collect();
    }
    Ok(found)
}

/// A pick's effect in another recording.
fn again<'c>(pool: &Pool<'c>, frame: &Frame<'_>, pick: &Pick) -> Option<Candidate<'c>> {
    let own = pool.like(frame, pick)?;
    match &own.finer {
        Finer::Settled => Some(own),
        Finer::Shape { at, .. } => at(*pick.shape.first()?),
        Finer::About(about) | Finer::Correction(about) => match pick.about.is_empty() {
            true => Some(own),
            false => about(&pick.about),
        },
    }
}

fn collected(problem: &Problem, rests: &[Vec<f64>; 2]) -> Vec<Unseen> {
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
