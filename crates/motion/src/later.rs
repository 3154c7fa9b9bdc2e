//! What the base model, and the effects beside it, leave of a second recording.

use std::rc::Rc;

use haptical_linalg::dot;
use haptical_model::Recording;

use crate::MotionError;
use crate::arm::Arm;
use crate::effect::{Candidate, Context, Finer, effect_names, ends_at};
use crate::fit::base::{Base, Term};
use crate::fit::column::Column;
use crate::fit::problem::{Problem, Reading};
use crate::fit::system::System;
use crate::select::{Fitted, Frame, Pick, Place, Pool, Selection, within_limits};
use crate::thresholds::select::REFUTED_NATS;
use crate::unseen::{Unseen, collected, end};

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
                memories: own.memories.clone(),
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

    /// The selection's picks as they act here.
    pub(crate) fn predicted<'p>(&'p self, selection: &'p Selection) -> Predicted<'p> {
        let torque = self
            .base
            .torque(&self.problem, &selection.bare.solved.solution);
        let context = Context {
            problem: &self.problem,
            base: &self.base,
            torque: &torque,
        };
        let frame = Frame::new(&self.problem, &self.base);
        // of the picks' effects alone
        let is_there = |name: &str| selection.picks.iter().any(|own| own.effect == name);
        let others: Vec<String> = (effect_names().into_iter())
            .filter(|name| !is_there(name))
            .map(str::to_owned)
            .collect();
        let pool = Pool::new(context, &others, &[]);
        let columns = selection.picks.iter().map(|pick| {
            let found = again(&pool, &frame, pick);
            found.map_or_else(Vec::new, |own| own.columns)
        });
        let columns: Vec<Vec<Rc<Column>>> = columns.collect();
        let here = Here {
            problem: &self.problem,
            base: &self.base,
        };
        let picks = columns.iter().zip(&selection.picks);
        let picks: Vec<_> = picks
            .map(|(columns, own)| (columns.as_slice(), own.coefficients.as_slice()))
            .collect();
        let before = here.rest(&selection.bare, 0.0, &[]);
        let mut after = here.rest(&selection.fitted, selection.early_s, &picks);
        for pick in &selection.picks {
            if let Some(ends) = ends_at(pick) {
                end(&self.problem, &mut after, ends);
            }
        }
        Predicted {
            here,
            selection,
            columns,
            before,
            after,
        }
    }
}

/// A second recording as a selection predicts it.
pub(crate) struct Predicted<'p> {
    here: Here<'p>,
    selection: &'p Selection,
    /// Columns of each pick; none of one that belongs to the first recording alone.
    columns: Vec<Vec<Rc<Column>>>,
    /// What the base model leaves, and what it leaves with the picks.
    before: Vec<f64>,
    after: Vec<f64>,
}

impl Predicted<'_> {
    /// What it leaves with the base model alone, and with the picks; a contact, which belongs to the first recording alone, is left out.
    pub(crate) fn unseen(self, first: (&Problem, &Base)) -> Vec<Unseen> {
        let problem = self.here.problem;
        let of_both = self.of_both(first);
        let is_predicted = self.is_predicted();
        let mut rests = [self.before, self.after];
        self.selection.put_in_readings(problem, &mut rests[1]);
        let mut found = collected(problem, &rests, (&is_predicted, None));
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
            let rows = (0..rows).filter(|row| is_predicted[channel * rows + row]);
            unseen.predictions = rows.map(at).collect();
            unseen.of_both = of_both.as_ref().map(|own| own[channel]);
        }
        found
    }

    /// Root mean squares over the noise of what one fit of both recordings leaves of each torque: a first recording that does not fix a
    /// number of the base model says nothing against a second one. None beside an effect that belongs to the first recording alone, or
    /// that ends readings.
    fn of_both(&self, (own, base): (&Problem, &Base)) -> Option<Vec<[f64; 2]>> {
        let picks = &self.selection.picks;
        if picks
            .iter()
            .any(|own| own.is_of_recording || ends_at(own).is_some())
        {
            return None;
        }
        let (first_rows, second_rows) = (own.channel_rows(), self.here.problem.channel_rows());
        let one_after_the_other = |(first, second): (&Rc<Column>, &Rc<Column>)| {
            let mut all = vec![0.0; first_rows + second_rows];
            first.add_to(&mut all[..first_rows], 1.0);
            second.add_to(&mut all[first_rows..], 1.0);
            Rc::new(Column::All(all))
        };
        let of_base = base.columns.iter().map(|own| &own.column);
        let there = self.here.base.columns.iter().map(|own| &own.column);
        let first = of_base.chain(picks.iter().flat_map(|own| &own.columns));
        let second = there.chain(self.columns.iter().flatten());
        let columns: Vec<Rc<Column>> = first.zip(second).map(one_after_the_other).collect();
        let effects: usize = picks.iter().map(|own| own.columns.len()).sum();
        if columns.len() != base.columns.len() + effects {
            return None;
        }
        let mut known: Vec<Option<f64>> = base.columns.iter().map(|own| own.known_sd).collect();
        known.resize(columns.len(), None);
        let early_s = self.selection.early_s;
        let mut recorded = own.recorded(early_s);
        recorded.extend(self.here.problem.recorded(early_s));
        let has_delay = picks.iter().any(|own| own.is_delay_of_all);
        let is_fixed = |term: &Term| has_delay && matches!(term, Term::Delay);
        let mut fixed: Vec<Option<f64>> = (base.columns.iter())
            .map(|own| is_fixed(&own.term).then_some(0.0))
            .collect();
        let system = System::new(&columns, &known);
        let found = within_limits(&system, base, &system.along(&recorded), &mut fixed);
        let rest = found.solved(&system, &recorded).rest;
        let rms = |rest: &[f64]| (dot(rest, rest) / rest.len() as f64).sqrt();
        let (first, second) = rest.split_at(first_rows);
        let channels = own.channels.len();
        let of_first = first.chunks(first_rows / channels);
        let of_second = second.chunks(second_rows / channels);
        Some(
            of_first
                .zip(of_second)
                .map(|(a, b)| [rms(a), rms(b)])
                .collect(),
        )
    }

    /// Rows of which the first recording determines both predictions.
    fn is_predicted(&self) -> Vec<bool> {
        let (bare, fitted) = (&self.selection.bare, &self.selection.fitted);
        let base = self.here.base.columns.iter();
        let base: Vec<_> = base.map(|own| Some(own.column.clone())).collect();
        // the effects' columns of a system, in whatever order they were taken
        let here = |own: &Rc<Column>| {
            let mut picks = self.selection.picks.iter().zip(&self.columns);
            picks.find_map(|(pick, here)| {
                let index = pick
                    .columns
                    .iter()
                    .position(|other| Rc::ptr_eq(own, other))?;
                here.get(index).cloned()
            })
        };
        let effects = fitted.system.columns[fitted.base_columns..]
            .iter()
            .map(here);
        let with: Vec<_> = base.iter().cloned().chain(effects).collect();
        let is_determined =
            |row| bare.solved.determines(&base, row) && fitted.solved.determines(&with, row);
        (0..self.before.len()).map(is_determined).collect()
    }

    /// Effects and joints of the picks without which this recording is predicted better: without each, the others and the base model
    /// are fitted to the first recording anew. Beside a pick that belongs to the first recording alone none is refuted, for then this
    /// one may have one of its own.
    pub(crate) fn refuted(&self, (own, base): (&Problem, &Base)) -> Vec<Place> {
        let picks = &self.selection.picks;
        if picks.iter().any(|own| own.is_of_recording) {
            return Vec::new();
        }
        let first = Frame::new(own, base);
        let refuted = (0..picks.len()).filter(|index| self.is_refuted(&first, *index));
        refuted
            .map(|index| (picks[index].effect, picks[index].joint))
            .collect()
    }

    fn is_refuted(&self, first: &Frame<'_>, index: usize) -> bool {
        let others = self.selection.picks.iter().zip(&self.columns);
        let others = others.enumerate().filter(|(other, _)| *other != index);
        let others: Vec<(&Pick, &Vec<Rc<Column>>)> = others.map(|(_, other)| other).collect();
        let has_delay = others.iter().any(|(own, _)| own.is_delay_of_all);
        let early_s = has_delay.then_some(self.selection.early_s);
        let columns = others
            .iter()
            .flat_map(|(own, _)| own.columns.iter().cloned());
        let columns: Vec<Rc<Column>> = columns.collect();
        let fitted = first.fitted(&columns, early_s);
        let mut left = fitted.effects();
        let with_own = others.into_iter().map(|(own, here)| {
            let (coefficients, further) = left.split_at(own.columns.len());
            left = further;
            (here.as_slice(), coefficients)
        });
        let with_own: Vec<_> = with_own.collect();
        let without = self.here.rest(&fitted, early_s.unwrap_or(0.0), &with_own);
        let energy = |rest: &[f64]| 0.5 * dot(rest, rest);
        let gain = energy(&without) - energy(&self.after);
        gain < -REFUTED_NATS
    }
}

/// The rows of the second recording.
struct Here<'p> {
    problem: &'p Problem,
    base: &'p Base,
}

impl Here<'_> {
    /// What a fit of the first recording leaves, with columns of effects and their coefficients.
    fn rest(&self, fitted: &Fitted, early_s: f64, effects: &[(&[Rc<Column>], &[f64])]) -> Vec<f64> {
        let mut rest = self.problem.recorded(early_s);
        for (column, value) in self.base.columns.iter().zip(&fitted.solved.solution) {
            column.column.add_to(&mut rest, -value);
        }
        for (columns, coefficients) in effects {
            for (column, value) in columns.iter().zip(*coefficients) {
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
