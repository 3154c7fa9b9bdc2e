//! One recording made ready for questions: base model fitted, outliers out, noise known, blocks cut.

mod base;
mod blocks;
mod descent;
mod determined;
mod earlier_model;
mod measured;
mod model;
mod onto_touches;
mod part;
mod prepared;
mod regression;
mod sampled;
mod segments;
mod system;
mod whitened;

use std::ops::Deref;
use std::sync::Arc;

use haptical_effects::{Context, Effect, Signal, Stream};
use haptical_linalg::SparseColumns;

use crate::Result;
use crate::noise::{KnownNoise, Noise, is_stated, of_two_parts, with_memory};
use crate::thresholds::noise::OTHER_LEVEL;

pub(crate) use self::base::problem::{BaseProblem, Derivatives};
pub(crate) use self::base::{Base, Unfinished};
pub(crate) use self::blocks::{Blocks, Layout};
pub(crate) use self::descent::nearby;
pub(crate) use self::determined::{Fit, Predicted};
pub(crate) use self::earlier_model::{own_sizes, placed, places};
pub(crate) use self::model::{Cause, Model, Refit};
pub(crate) use self::onto_touches::onto_touches;
pub(crate) use self::part::{Part, root_mean_square, square};
pub(crate) use self::prepared::Prepared;
pub(crate) use self::regression::{Columns, Regression};
pub(crate) use self::segments::{Segments, Unseen};
pub(crate) use self::system::{
    ALWAYS, Column, SlowEnergy, System, across, dot, mask, oscillations, take_off, take_off_all,
    windows,
};
pub(crate) use self::whitened::{Fitting, difference};

/// One recording with its base model.
#[derive(Debug)]
pub(crate) struct Engine<'a> {
    data: Prepared<'a>,
    pub(crate) noise: Vec<Noise>,
    /// What the speed makes of the stated deviations at each row, where it does.
    scale: Vec<Option<Vec<f64>>>,
    /// Noise floor per stream: root mean square in the stream's unit.
    pub(crate) floor: Vec<f64>,
    pub(crate) system: System,
    /// What refits are made with.
    pub(crate) whole: Part,
    /// The base model alone.
    pub(crate) start: Refit,
    /// A model with causes that another fit of the log has found.
    near: Option<Model>,
}

impl<'a> Deref for Engine<'a> {
    type Target = Prepared<'a>;

    fn deref(&self) -> &Self::Target {
        &self.data
    }
}

/// A noise with a memory by residuals over the stated deviation, run by run; whether that is stated.
type Memory = fn(&[f64], &[std::ops::Range<usize>], bool) -> Option<Noise>;

impl Engine<'_> {
    fn known(&self) -> KnownNoise {
        KnownNoise {
            noise: self.noise.clone(),
            scale: self.scale.clone(),
        }
    }

    /// Noises with a memory that other residuals show, in the streams where their level is another one: of the size that the file states
    /// where it does, and of two parts. None where there is no such stream.
    pub(crate) fn noises_with_memory(&self, residual: &[Vec<f64>]) -> Vec<KnownNoise> {
        if !self.context.ordered {
            return Vec::new();
        }
        let kinds: [Memory; 2] = [with_memory, of_two_parts];
        let all = kinds.into_iter();
        all.filter_map(|kind| self.noise_with_memory(residual, kind))
            .collect()
    }

    fn noise_with_memory(&self, residual: &[Vec<f64>], kind: Memory) -> Option<KnownNoise> {
        let mut known = self.known();
        let mut is_other = false;
        for (stream, noise) in known.noise.iter_mut().enumerate() {
            let scaled = self.over_stated(stream, &residual[stream]);
            let stated = is_stated(self.context.device, self.context.streams[stream].channel);
            let Some(slow) = kind(&scaled, &self.context.runs, stated) else {
                continue;
            };
            if slow.level() > OTHER_LEVEL * noise.level() {
                *noise = slow;
                known.scale[stream] = None;
                is_other = true;
            }
        }
        is_other.then_some(known)
    }

    /// Whether the recording is one of touches in single postures whose noise no rig states: it is then taken
    /// from what the base model leaves, gap and all.
    pub(crate) fn is_noise_unknown(&self) -> bool {
        let context = &self.context;
        let unstated =
            |stream: &Stream| stream.is_touch() && !is_stated(context.device, stream.channel);
        !context.ordered && context.streams.iter().any(unstated)
    }

    /// The rows of this recording that `seen` picks.
    pub(crate) fn part(&self, seen: &dyn Fn(usize) -> bool) -> Result<Part> {
        let seen = |rows: &Vec<bool>| {
            let rows = rows.iter().enumerate();
            rows.map(|(row, usable)| *usable && seen(row)).collect()
        };
        let usable: Vec<Vec<bool>> = self.usable.iter().map(seen).collect();
        let blocks = Blocks::new(&self.context, &usable, &self.own, &self.known());
        self.part_of(blocks, self.derivatives.as_ref())
    }

    /// Whitened derivatives of the base model's free parameters.
    pub(crate) fn free(&self) -> &SparseColumns {
        &self.whole.free
    }

    /// Root mean square change of the base model's predictions from its own fit to another, whose residuals
    /// are given, in noise deviations.
    pub(crate) fn moved(&self, there: &[Vec<f64>]) -> f64 {
        let change = differences(there, &self.start.residual);
        root_mean_square(&self.system.layout.compress_rows(&change))
    }

    /// What the base model leaves of a stream beyond noise, squares over the noise's.
    pub(crate) fn gap_over_noise(&self, stream: usize) -> f64 {
        let known = self.start.residual[stream]
            .iter()
            .filter(|own| own.is_finite());
        let squares: f64 = known.clone().map(|own| own * own).sum();
        squares / (known.count().max(1) as f64 * self.floor[stream].max(1e-300).powi(2)) - 1.0
    }

    /// Residuals of a model of another recording at every row of this one.
    pub(crate) fn residual_of(
        &self,
        effects: &[Box<dyn Effect>],
        values: &[f64],
        causes: &[Cause],
    ) -> Result<Vec<Vec<f64>>> {
        let bare = self.problem.evaluate(values, false)?.residual;
        Ok(with_causes(bare, &self.context, effects, causes))
    }

    /// The same as a device with the causes leaves it: with the chain moved as far as they move it.
    pub(crate) fn exact_residual(
        &self,
        effects: &[Box<dyn Effect>],
        model: &Model,
    ) -> Vec<Vec<f64>> {
        let shown = |cause: &Cause| cause.exact_contribution(effects, &self.context);
        without(model.bare.to_vec(), model.causes.iter().map(shown))
    }

    /// Refits base model and causes together on all rows.
    pub(crate) fn refit(&self, effects: &[Box<dyn Effect>], model: &Model) -> Result<Refit> {
        self.refit_on(&self.whole, effects, model, None)
    }

    /// Refits base model and causes together from `model`; where that ends above the base model alone, from the
    /// base model with the causes at nothing, from where no step leads up. With `least_fall` the minimum is only compared with others:
    /// a slow search ends where a step lowers the cost by less than that share.
    pub(crate) fn refit_on(
        &self,
        part: &Part,
        effects: &[Box<dyn Effect>],
        model: &Model,
        least_fall: Option<f64>,
    ) -> Result<Refit> {
        let fitting = Fitting {
            data: self,
            effects,
            part,
            least_fall,
        };
        let fitted = fitting.descend(model)?;
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
        let again = fitting.descend(&nothing)?;
        Ok(if cost(&again) < cost(&fitted) {
            again
        } else {
            fitted
        })
    }

    /// Lets refits of a model's causes begin with that model, which another fit of the log has found.
    pub(crate) fn know(&mut self, mut model: Model) -> Result<()> {
        let bare = self.problem.evaluate(&model.values, false)?;
        model.bare = Arc::new(bare.residual);
        self.near = Some(model);
        Ok(())
    }

    /// The known model, where its causes are the same effects, none of them an event.
    pub(crate) fn known_with(&self, causes: &[Cause]) -> Option<&Model> {
        let near = self.near.as_ref()?;
        let mut pairs = near.causes.iter().zip(causes);
        let are_same = near.causes.len() == causes.len()
            && pairs.all(|(a, b)| a.effect == b.effect && a.times.is_empty() && b.times.is_empty());
        are_same.then_some(near)
    }

    /// Squared residuals of a refit on all rows, and of its anchors.
    pub(crate) fn cost(&self, refit: &Refit) -> f64 {
        self.cost_on(&self.whole, refit)
    }

    fn cost_on(&self, part: &Part, refit: &Refit) -> f64 {
        square(part, &refit.residual, &self.base.pull(&refit.model.values))
    }
}

/// Residuals of one model less those of another, per stream and row.
pub(crate) fn differences(one: &[Vec<f64>], other: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let streams = one.iter().zip(other);
    let rows = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| a - b).collect();
    streams.map(rows).collect()
}

/// Residuals once the causes are in the model.
pub(crate) fn with_causes(
    residual: Vec<Vec<f64>>,
    context: &Context<'_>,
    effects: &[Box<dyn Effect>],
    causes: &[Cause],
) -> Vec<Vec<f64>> {
    let shown = |cause: &Cause| cause.contribution(effects, context);
    without(residual, causes.iter().map(shown))
}

/// Residuals without signals.
fn without(mut residual: Vec<Vec<f64>>, signals: impl Iterator<Item = Signal>) -> Vec<Vec<f64>> {
    for signal in signals {
        for (stream, values) in &signal.parts {
            for (entry, value) in residual[*stream].iter_mut().zip(values) {
                *entry -= value;
            }
        }
    }
    residual
}
