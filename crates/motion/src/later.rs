//! What the base model, and the effects beside it, leave of a second recording.

use std::rc::Rc;

use haptical_linalg::dot;
use haptical_model::Recording;

use crate::MotionError;
use crate::arm::Arm;
use crate::effect::{Candidate, Context, Finer, effect_names, is_of_own_joint};
use crate::fit::base::Base;
use crate::fit::column::Column;
use crate::fit::problem::{Problem, Reading};
use crate::select::{
    Fitted, Frame, LEAST_NATS, OF_OWN_JOINT, Pick, Pool, Selection, gained_by_channel,
};
use crate::unseen::{Unseen, collected};

/// What a pick makes worse of a second recording that refutes it \[nats\].
const REFUTED_NATS: f64 = 4.0;

/// A second recording, to be predicted by what the first one shows.
pub(crate) struct Later {
    problem: Problem,
    base: Base,
}

impl Later {
    /// # Errors
    /// [`MotionError`] for a recording that says nothing of a moving arm, or not of the same joints.
    pub(crate) fn new(
        arm: &Arm,
        second: &Recording,
        (own, base): (&Problem, &Base),
    ) -> Result<Self, MotionError> {
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
        Ok(Self {
            problem,
            base: there,
        })
    }

    /// What it leaves with the base model alone, and with the picks; those that belong to the first recording alone, as a contact does, are
    /// left out.
    pub(crate) fn unseen(&self, selection: &Selection) -> Vec<Unseen> {
        let problem = &self.problem;
        let rests = [self.before(selection), self.after(selection)];
        let mut found = collected(problem, &rests);
        let rows = problem.states.rows();
        for (channel, unseen) in found.iter_mut().enumerate() {
            let torque = problem.states.torque(&problem.samples, unseen.joint, 0.0);
            let at = |row: usize| {
                let k = channel * rows + row;
                let [before, after] =
                    [0, 1].map(|own: usize| torque[row] - rests[own][k] / problem.weight(k));
                (
                    problem.states.row_of[problem.states.centre[row]],
                    [torque[row], before, after],
                )
            };
            unseen.predictions = (0..rows).map(at).collect();
        }
        found
    }

    /// Effects and joints of the picks without which this recording is predicted better, or which are missed at other joints than their own:
    /// without each, the others and the base model are fitted to the first recording anew. Beside a pick that belongs to the first recording alone none is refuted, for then this one may have
    /// one of its own.
    pub(crate) fn refuted(
        &self,
        (own, base): (&Problem, &Base),
        selection: &Selection,
    ) -> Vec<(&'static str, Option<usize>)> {
        if selection.picks.iter().any(|own| own.is_of_recording) {
            return Vec::new();
        }
        let first = Frame::new(own, base);
        let after = self.after(selection);
        let energy = |rest: &[f64]| 0.5 * dot(rest, rest);
        let is_refuted = |index: &usize| {
            let mut others: Vec<&Pick> = selection.picks.iter().collect();
            others.remove(*index);
            let early_s =
                (others.iter().any(|own| own.is_delay_of_all)).then_some(selection.early_s);
            let columns: Vec<Rc<Column>> = (others.iter())
                .flat_map(|own| own.columns.iter().cloned())
                .collect();
            let fitted = first.fitted(&columns, early_s);
            let mut left = fitted.effects();
            let with_own = others.into_iter().map(|own| {
                let (coefficients, rest) = left.split_at(own.columns.len());
                left = rest;
                (own, coefficients)
            });
            let with_own: Vec<(&Pick, &[f64])> = with_own.collect();
            let without = self.rest(selection, &fitted, early_s.unwrap_or(0.0), &with_own);
            let gain = energy(&without) - energy(&after);
            let own = &selection.picks[*index];
            gain < -REFUTED_NATS
                || gain > LEAST_NATS && self.share_of_own(own, [&without, &after]) < OF_OWN_JOINT
        };
        let refuted = (0..selection.picks.len()).filter(is_refuted);
        refuted
            .map(|index| (selection.picks[index].effect, selection.picks[index].joint))
            .collect()
    }

    /// Share of what one rest has less than another that is of a pick's own joint; 1 of an effect that acts on others' too.
    fn share_of_own(&self, pick: &Pick, [without, with]: [&[f64]; 2]) -> f64 {
        let joint = pick.joint.filter(|_| is_of_own_joint(pick.effect));
        let Some(channel) = joint.and_then(|joint| self.problem.channel_of(joint)) else {
            return 1.0;
        };
        gained_by_channel(self.problem.states.rows(), [without, with], channel)
    }

    fn before(&self, selection: &Selection) -> Vec<f64> {
        self.rest(selection, &selection.bare, 0.0, &[])
    }

    fn after(&self, selection: &Selection) -> Vec<f64> {
        let picks = selection.picks.iter();
        let picks: Vec<(&Pick, &[f64])> = picks
            .map(|own| (own, own.coefficients.as_slice()))
            .collect();
        self.rest(selection, &selection.fitted, selection.early_s, &picks)
    }

    /// What a fit of the first recording leaves of this one, with picks and their coefficients.
    fn rest(
        &self,
        selection: &Selection,
        fitted: &Fitted,
        early_s: f64,
        picks: &[(&Pick, &[f64])],
    ) -> Vec<f64> {
        let (problem, base) = (&self.problem, &self.base);
        let mut rest = problem.recorded(early_s);
        for (column, value) in base.columns.iter().zip(&fitted.solved.solution) {
            column.column.add_to(&mut rest, -value);
        }
        let torque = base.torque(problem, &selection.bare.solved.solution);
        let context = Context {
            problem,
            base,
            torque: &torque,
        };
        let frame = Frame::new(problem, base);
        // of the picks' effects alone
        let is_there = |name: &str| picks.iter().any(|own| own.0.effect == name);
        let others: Vec<String> = (effect_names().into_iter())
            .filter(|name| !is_there(name))
            .map(str::to_owned)
            .collect();
        let pool = Pool::new(context, &others, &[]);
        for (pick, coefficients) in picks {
            let Some(candidate) = again(&pool, &frame, pick) else {
                continue;
            };
            for (column, value) in candidate.columns.iter().zip(*coefficients) {
                column.add_to(&mut rest, -value);
            }
        }
        rest
    }
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
