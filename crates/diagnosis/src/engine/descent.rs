//! Base model, alone or with causes, as one least-squares problem, and the search for its minimum.

use std::borrow::Cow;
use std::sync::Arc;

use haptical_effects::{Context, Effect, Shape, Signal};
use haptical_identification::Convergence;

use super::prepared::BaseFit;
use crate::Result;
use crate::engine::{Base, Blocks, Cause, Model, Part, Prepared, Refit, Step, square, with_causes};
use crate::noise::KnownNoise;
use crate::thresholds::engine::WIDTH_STEP;
use crate::thresholds::fit::{
    BASE_PASSES, FRESH_WITHIN, LEAST_FALL, PASSES, SHORTENED_STEPS, SHORTER, STILL_SD,
};

/// What a fit of base model and causes is made of.
#[derive(Clone, Copy)]
pub(crate) struct Fitting<'r> {
    pub(crate) data: &'r Prepared<'r>,
    pub(crate) effects: &'r [Box<dyn Effect>],
    /// The rows that it sees.
    pub(crate) part: &'r Part,
}

/// A model with its residuals and their square.
struct Here {
    model: Model,
    residual: Vec<Vec<f64>>,
    cost: f64,
}

impl Fitting<'_> {
    /// Searches the minimum from `model` by Gauss-Newton, with shorter steps where a whole one overshoots, until the linearised
    /// problem promises next to nothing. The base model's derivatives are those of the part until a step calls for new ones. The
    /// causes' columns are projected across the base model's directions, which gives their steps and covariance; what they leave
    /// gives the base model's step.
    pub(crate) fn descend(&self, model: &Model) -> Result<Refit> {
        let mut here = self.evaluated(self.part, model.clone());
        let mut part = Cow::Borrowed(self.part);
        let owners = owners(self.effects, &model.causes);
        let rows = self.part.blocks.count();
        let freedom = rows
            .saturating_sub(self.data.base.free.len() + owners.len())
            .max(1) as f64;
        let (mut covariance, mut promised, mut last_step) = (None, f64::INFINITY, f64::INFINITY);
        let mut convergence = Convergence::IterationLimit;
        // how far the predictions moved since the derivatives were taken, in noise deviations; new ones at once are none of the part
        let (mut moved, mut is_fresh) = (0.0, false);
        for _ in 0..PASSES {
            self.data.base.interrupt.check()?;
            let columns = by_cause(self, &here.model);
            let pull = self.data.base.pull(&here.model.values);
            let step = part.step(&columns, &here.residual, &pull)?;
            let are_causes_still = self.are_causes_still(&step, here.cost / freedom);
            covariance = step.covariance.or(covariance);
            (promised, last_step) = (step.explained, step.size);
            let is_at_minimum = has_settled(promised, here.cost, freedom);
            if is_at_minimum && (is_fresh || moved < FRESH_WITHIN) {
                convergence = Convergence::SmallCostChange;
                break;
            }
            let taken = match is_at_minimum {
                true => None,
                false => self.shortened(&part, &here, &owners, &step.values),
            };
            let gain = taken.as_ref().map_or(0.0, |next| here.cost - next.cost);
            let has_moved = taken.is_some();
            here = taken.unwrap_or(here);
            moved += if has_moved { step.size } else { 0.0 };
            // at a minimum, rounding may promise less than nothing
            let is_slow = is_at_minimum || gain < 0.5 * promised;
            // a promise that the way does not keep: a valley of the base model, along which no cause changes
            let is_flat = is_fresh && is_slow && has_settled(gain, here.cost, freedom);
            if is_flat && (are_causes_still || !has_moved) {
                convergence = match are_causes_still {
                    true => Convergence::SmallCostChange,
                    false => Convergence::NoFurtherDescent,
                };
                break;
            }
            is_fresh = is_slow;
            if is_slow {
                let there = self.data.problem.evaluate(&here.model.values, true)?;
                let blocks = part.blocks.clone();
                part = Cow::Owned(self.data.part_of(blocks, there.derivatives.as_ref())?);
                moved = 0.0;
            }
        }
        Ok(Refit {
            model: here.model,
            residual: here.residual,
            covariance,
            promised,
            convergence,
            last_step,
        })
    }

    /// Whether a step moves no number of the causes by more than a tenth of its standard deviation, by the variance of what is left.
    fn are_causes_still(&self, step: &Step, variance: f64) -> bool {
        let changes = step.values.iter().skip(self.data.base.free.len());
        let mut changes = changes.enumerate();
        let sd = |index: usize| {
            let own = step.covariance.as_ref()?[(index, index)];
            Some((own * variance.max(1.0)).sqrt())
        };
        changes.all(|(index, change)| sd(index).is_some_and(|sd| change.abs() <= STILL_SD * sd))
    }

    /// A model whose residuals without causes are known.
    fn evaluated(&self, part: &Part, model: Model) -> Here {
        let bare = model.bare.to_vec();
        let residual = with_causes(bare, &self.data.context, self.effects, &model.causes);
        let cost = square(part, &residual, &self.data.base.pull(&model.values));
        Here {
            model,
            residual,
            cost,
        }
    }

    /// The model after the longest share of a step that lowers the cost; none where none does.
    fn shortened(&self, part: &Part, here: &Here, owners: &[Owner], step: &[f64]) -> Option<Here> {
        let shares = std::iter::successors(Some(1.0), |share| Some(SHORTER * share));
        shares.take(SHORTENED_STEPS).find_map(|share| {
            let mut next = here.model.clone();
            self.data.base.step(&mut next.values, step, share);
            for (owner, change) in owners.iter().zip(&step[self.data.base.free.len()..]) {
                apply(&mut next.causes, *owner, share * change);
            }
            let bare = self.data.problem.evaluate(&next.values, false).ok()?;
            next.bare = Arc::new(bare.residual);
            let next = self.evaluated(part, next);
            (next.cost < here.cost).then_some(next)
        })
    }
}

/// Whether the fall of the cost that the linearised problem promises is below a hundredth of the variance of what is left, or of
/// the noise where that is more: every number is then within a tenth of its standard deviation of the minimum.
pub(crate) fn has_settled(promised: f64, cost: f64, freedom: f64) -> bool {
    promised <= LEAST_FALL * (cost / freedom).max(1.0)
}

/// Whose number a column of a refit is.
#[derive(Debug, Clone, Copy)]
enum Owner {
    Amplitude(usize, usize),
    /// Logarithm of a shape.
    LogShape(usize),
}

/// Whose the numbers of causes are, in their order.
fn owners(effects: &[Box<dyn Effect>], causes: &[Cause]) -> Vec<Owner> {
    let of_cause = |(index, cause): (usize, &Cause)| {
        let amplitudes = 0..cause.amplitudes.len();
        let shape = effects[cause.effect].spec().shape;
        amplitudes
            .map(move |amplitude| Owner::Amplitude(index, amplitude))
            .chain(shape.is_continuous().then_some(Owner::LogShape(index)))
    };
    causes.iter().enumerate().flat_map(of_cause).collect()
}

fn apply(causes: &mut [Cause], owner: Owner, change: f64) {
    match owner {
        Owner::Amplitude(cause, amplitude) => causes[cause].amplitudes[amplitude] += change,
        // a law may be another one farther away
        Owner::LogShape(cause) => causes[cause].shape *= change.clamp(-0.7, 0.7).exp(),
    }
}

/// Whitened derivatives of all causes' numbers, in the order of their owners.
fn by_cause(fitting: &Fitting<'_>, model: &Model) -> Vec<Vec<f64>> {
    let (context, effects) = (&fitting.data.context, fitting.effects);
    let of_cause = |cause: &Cause| {
        let effect = &effects[cause.effect];
        let mut signals = match effect.spec().shape {
            Shape::Sides if cause.amplitudes.iter().any(|own| *own != 0.0) => {
                by_differences(cause, effects, context)
            }
            _ => cause.derivative(effects, context),
        };
        if effect.spec().shape.is_continuous() {
            let step = effect.shape_step(context, cause.shape);
            let at = |shape: f64| effect.signal(context, &cause.amplitudes, shape);
            let higher = at(cause.shape * (1.0 + step));
            signals.push(difference(
                &higher,
                &at(cause.shape * (1.0 - step)),
                2.0 * step,
            ));
        }
        signals
    };
    let signals = model.causes.iter().flat_map(of_cause);
    signals.map(|own| fitting.part.blocks.dense(&own)).collect()
}

/// Change of a play per change of its width: its column, the output per width, is another one while the play is crossed.
fn by_differences(
    cause: &Cause,
    effects: &[Box<dyn Effect>],
    context: &Context<'_>,
) -> Vec<Signal> {
    let of_amplitude = |index: usize| {
        let step = WIDTH_STEP * cause.amplitudes[index].abs().max(f64::MIN_POSITIVE);
        let moved = |change: f64| {
            let mut moved = cause.clone();
            moved.amplitudes[index] += change;
            moved.contribution(effects, context)
        };
        difference(&moved(step), &moved(-step), 2.0 * step)
    };
    (0..cause.amplitudes.len()).map(of_amplitude).collect()
}

/// Change of a signal per step of a number.
pub(crate) fn difference(higher: &Signal, lower: &Signal, step: f64) -> Signal {
    let mut slope = Signal::default();
    slope.add(higher, 1.0 / step);
    slope.add(lower, -1.0 / step);
    slope
}

impl Prepared<'_> {
    /// Fits the base model; the noise is estimated anew where the start was far from it.
    pub(super) fn base_fit(
        &self,
        mut residual: Vec<Vec<f64>>,
        known: Option<&KnownNoise>,
    ) -> Result<BaseFit> {
        let mut values = self.problem.start();
        let mut pass = 0;
        loop {
            let known = known.cloned().unwrap_or_else(|| self.noise_of(&residual));
            let blocks = Blocks::new(&self.context, &self.usable, &self.own, &known);
            let whole = self.part_of(blocks, self.derivatives.as_ref())?;
            let evaluate = |values: &[f64]| Ok(self.problem.evaluate(values, false)?.residual);
            let mut fit = nearby(&whole, self.base, (values, residual), &evaluate)?;
            let is_near = fit.has_converged();
            // where the calibration's own search found no minimum, another one leads away from what causes can mend
            if !is_near && self.base.unfinished.is_none() {
                // the derivatives of the start may not lead to the minimum
                let found = Fitting {
                    data: self,
                    effects: &[],
                    part: &whole,
                };
                let found = found.descend(&fit.model)?;
                fit = if found.has_converged() { found } else { fit };
            }
            pass += 1;
            // a start far away has shown noise that is partly the way's
            if pass > 1 || is_near {
                return Ok(BaseFit { known, whole, fit });
            }
            (values, residual) = (fit.model.values, fit.residual);
        }
    }
}

/// Residuals of the base model at its values, per stream and row.
type Evaluate<'e> = dyn Fn(&[f64]) -> Result<Vec<Vec<f64>>> + 'e;

/// The base model's minimum by Gauss-Newton with the derivatives of a part, from values and their residuals: a few steps with one
/// decomposition, as long as the cost falls.
pub(crate) fn nearby(
    part: &Part,
    base: &Base,
    (values, residual): (Vec<f64>, Vec<Vec<f64>>),
    evaluate: &Evaluate<'_>,
) -> Result<Refit> {
    let rows = part.blocks.count() as f64;
    let freedom = (rows - base.free.len() as f64).max(1.0);
    let mut near = Refit {
        model: Model {
            values,
            bare: Arc::default(),
            causes: Vec::new(),
        },
        residual,
        covariance: None,
        promised: 0.0,
        convergence: Convergence::IterationLimit,
        last_step: 0.0,
    };
    let mut cost = square(part, &near.residual, &base.pull(&near.model.values));
    for _ in 0..=BASE_PASSES {
        base.interrupt.check()?;
        let Some((step, promised)) =
            part.base_step(&near.residual, &base.pull(&near.model.values))?
        else {
            near.convergence = Convergence::SmallCostChange;
            break;
        };
        near.promised = promised;
        near.last_step = (promised / rows.max(1.0)).sqrt();
        if has_settled(promised, cost, freedom) {
            near.convergence = Convergence::SmallCostChange;
            break;
        }
        let mut next = near.model.values.clone();
        base.step(&mut next, &step, 1.0);
        let Ok(rest) = evaluate(&next) else { break };
        let less = square(part, &rest, &base.pull(&next));
        if less.is_nan() || less >= cost {
            break;
        }
        (near.model.values, near.residual, cost) = (next, rest, less);
    }
    near.model.bare = Arc::new(near.residual.clone());
    Ok(near)
}
