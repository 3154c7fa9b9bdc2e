//! Refits of base model and causes together.

use std::sync::Arc;

use haptical_effects::Effect;

use crate::DiagnosisError;
use crate::engine::Engine;
use crate::engine::model::{Cause, Model, Refit};
use crate::engine::part::{Part, dense, square};
use crate::thresholds::fit::{PASSES, SHORTENED_STEPS, SHORTER, SMALL_STEP};

/// What the longest share of a step gives that gives anything; `at` gives none where the cost does not fall.
pub(crate) fn longest_falling<T>(mut at: impl FnMut(f64) -> Option<T>) -> Option<T> {
    let shares = std::iter::successors(Some(1.0), |share| Some(SHORTER * share));
    shares.take(SHORTENED_STEPS).find_map(&mut at)
}

impl Engine<'_> {
    /// Refits base model and causes together on all rows.
    pub(crate) fn refit(
        &self,
        effects: &[Box<dyn Effect>],
        model: &Model,
    ) -> Result<Refit, DiagnosisError> {
        self.refit_on(&self.whole, effects, model)
    }

    /// Refits base model and causes together from `model`; where that ends above the base model alone, from the
    /// base model with the causes at nothing, from where no step leads up.
    pub(crate) fn refit_on(
        &self,
        part: &Part,
        effects: &[Box<dyn Effect>],
        model: &Model,
    ) -> Result<Refit, DiagnosisError> {
        let fitted = self.descend(part, effects, model)?;
        let cost = |refit: &Refit| self.cost_on(part, refit);
        let alone = &self.start;
        if model.causes.is_empty() || cost(&fitted) <= cost(alone) {
            return Ok(fitted);
        }
        let mut nothing = alone.model.clone();
        nothing.causes.clone_from(&model.causes);
        for cause in &mut nothing.causes {
            cause.amplitudes.fill(0.0);
        }
        let again = self.descend(part, effects, &nothing)?;
        Ok(if cost(&again) < cost(&fitted) {
            again
        } else {
            fitted
        })
    }

    /// Squared residuals of a refit on all rows, and of its anchors.
    pub(crate) fn cost(&self, refit: &Refit) -> f64 {
        self.cost_on(&self.whole, refit)
    }

    fn cost_on(&self, part: &Part, refit: &Refit) -> f64 {
        square(part, &refit.residual, &self.base.pull(&refit.model.values))
    }

    /// Refits base model and causes together by Gauss-Newton from `model`, with shorter steps where a
    /// whole one overshoots. The base model's derivatives are those of its own fit until a step calls
    /// for new ones. The causes' columns are projected across the base model's directions, which gives
    /// their steps and covariance; what they leave gives the base model's step.
    fn descend(
        &self,
        part: &Part,
        effects: &[Box<dyn Effect>],
        model: &Model,
    ) -> Result<Refit, DiagnosisError> {
        let mut model = model.clone();
        let mut residual = self.residual(effects, &model);
        let mut cost = square(part, &residual, &self.base.pull(&model.values));
        let mut covariance = None;
        let mut last_step = f64::INFINITY;
        let mut refreshed: Option<Part> = None;
        for pass in 0..PASSES {
            self.base.interrupt.check()?;
            let current = refreshed.as_ref().unwrap_or(part);
            let (columns, owners) = self.cause_columns(current, effects, &model);
            let pull = self.base.pull(&model.values);
            let step = current.step(&columns, &residual, &pull)?;
            covariance = step.covariance.or(covariance);
            last_step = step.size;
            if last_step < SMALL_STEP {
                break;
            }
            let taken = self.shortened(current, effects, &model, &owners, &step.values, cost);
            let is_slow = match taken {
                Some((next, rest, less)) => {
                    let gain = cost - less;
                    (model, residual, cost) = (next, rest, less);
                    gain < 0.5 * step.explained
                }
                None => true,
            };
            if is_slow {
                if refreshed.is_some() && pass > 2 {
                    break;
                }
                refreshed = Some(self.part_at(current, &model.values)?);
            }
        }
        Ok(Refit {
            model,
            residual,
            covariance,
            last_step,
        })
    }

    /// The base model with the causes' columns at other values.
    fn part_at(&self, part: &Part, values: &[f64]) -> Result<Part, DiagnosisError> {
        let derivatives = self.problem.evaluate(values, true)?.derivatives;
        let blocks = part.blocks.clone();
        let derivatives = derivatives.as_ref();
        Part::new(&self.context, &self.problem, blocks, derivatives, self.base)
    }

    /// The model after a step, shortened until the cost falls; none where it never does.
    fn shortened(
        &self,
        part: &Part,
        effects: &[Box<dyn Effect>],
        model: &Model,
        owners: &[Owner],
        step: &[f64],
        cost: f64,
    ) -> Option<(Model, Vec<Vec<f64>>, f64)> {
        longest_falling(|share| {
            let mut next = model.clone();
            for (&parameter, change) in self.base.free.iter().zip(step) {
                next.values[parameter] += share * change;
            }
            for (owner, change) in owners.iter().zip(&step[self.base.free.len()..]) {
                apply(&mut next.causes, *owner, share * change);
            }
            let bare = self.problem.evaluate(&next.values, false).ok()?;
            next.bare = Arc::new(bare.residual);
            let residual = self.residual(effects, &next);
            let square = square(part, &residual, &self.base.pull(&next.values));
            (square < cost).then_some((next, residual, square))
        })
    }

    /// Whitened derivatives of all causes' numbers, with whose they are.
    fn cause_columns(
        &self,
        part: &Part,
        effects: &[Box<dyn Effect>],
        model: &Model,
    ) -> (Vec<Vec<f64>>, Vec<Owner>) {
        let mut columns = Vec::new();
        let mut owners = Vec::new();
        for (index, cause) in model.causes.iter().enumerate() {
            let effect = &effects[cause.effect];
            let signals = cause.derivative(effects, &self.context);
            for (amplitude, signal) in signals.iter().enumerate() {
                columns.push(dense(part, signal));
                owners.push(Owner::Amplitude(index, amplitude));
            }
            if effect.spec().shape.is_continuous() {
                let step = effect.shape_step(&self.context, cause.shape);
                let at = |shape: f64| effect.signal(&self.context, &cause.amplitudes, shape);
                let mut slope = at(cause.shape * (1.0 + step));
                slope.add(&at(cause.shape * (1.0 - step)), -1.0);
                let mut dense = dense(part, &slope);
                dense.iter_mut().for_each(|entry| *entry /= 2.0 * step);
                columns.push(dense);
                owners.push(Owner::LogShape(index));
            }
        }
        (columns, owners)
    }
}

/// Whose number a column of a refit is.
#[derive(Debug, Clone, Copy)]
enum Owner {
    Amplitude(usize, usize),
    LogShape(usize),
}

fn apply(causes: &mut [Cause], owner: Owner, change: f64) {
    match owner {
        Owner::Amplitude(cause, amplitude) => causes[cause].amplitudes[amplitude] += change,
        Owner::LogShape(cause) => causes[cause].shape *= change.clamp(-0.7, 0.7).exp(),
    }
}
