//! One recording made ready for questions: base model fitted, outliers out, noise known, blocks cut.

pub(crate) mod base;
pub(crate) mod base_fit;
pub(crate) mod blocks;
pub(crate) mod descent;
pub(crate) mod determined;
pub(crate) mod earlier_model;
pub(crate) mod layout;
pub(crate) mod least;
pub(crate) mod model;
pub(crate) mod onto_touches;
pub(crate) mod own_sizes;
pub(crate) mod part;
pub(crate) mod refit;
pub(crate) mod regression;
pub(crate) mod segments;
pub(crate) mod system;

mod prepared;

use haptical_effects::{Context, Effect, Signal, Stream};
use haptical_linalg::SparseColumns;

use crate::DiagnosisError;
use crate::engine::base::Base;
use crate::engine::base::problem::{BaseProblem, Derivatives};
use crate::engine::blocks::Blocks;
use crate::engine::model::{Cause, Model, Refit};
use crate::engine::part::{Part, root_mean_square};
use crate::engine::system::{System, compress_rows};
use crate::noise::measured::{KnownNoise, estimate_noise, over_stated};
use crate::noise::stated::is_stated;
use crate::noise::{Noise, with_memory};
use crate::thresholds::noise::OTHER_LEVEL;

pub(crate) use self::prepared::Prepared;

/// One recording with its base model.
#[derive(Debug)]
pub(crate) struct Engine<'a> {
    pub(crate) context: Context<'a>,
    pub(crate) problem: BaseProblem<'a>,
    pub(crate) base: &'a Base,
    pub(crate) noise: Vec<Noise>,
    /// Noise floor per stream: root mean square in the stream's unit.
    pub(crate) floor: Vec<f64>,
    /// Rows with a usable reading, per stream.
    pub(crate) usable: Vec<Vec<bool>>,
    pub(crate) system: System,
    /// The sensors' own stated deviations, per stream.
    own: Vec<f64>,
    /// What the speed makes of them at each row, where it does.
    scale: Vec<Option<Vec<f64>>>,
    /// Derivatives of all parameters at every row.
    derivatives: Option<Derivatives>,
    /// What refits are made with.
    pub(crate) whole: Part,
    /// The base model alone.
    pub(crate) start: Refit,
}

impl Engine<'_> {
    /// The noise by other residuals than the base model's: with the causes in the model, fast parts of
    /// their gap no longer pass for noise.
    pub(crate) fn noise_of(&self, residual: &[Vec<f64>]) -> KnownNoise {
        let (noise, scale) = estimate_noise(
            &self.context,
            &self.problem,
            residual,
            &self.usable,
            &self.own,
            self.base.free.len(),
        );
        KnownNoise { noise, scale }
    }

    /// The noise with a memory that other residuals show, of the size that the file states where it does, in the streams
    /// where its level is another one; none where there is no such stream.
    pub(crate) fn noise_with_memory(&self, residual: &[Vec<f64>]) -> Option<KnownNoise> {
        if !self.context.ordered {
            return None;
        }
        let mut known = KnownNoise {
            noise: self.noise.clone(),
            scale: self.scale.clone(),
        };
        let mut is_other = false;
        for (stream, noise) in known.noise.iter_mut().enumerate() {
            let (sd, usable) = (&self.problem.sd[stream], &self.usable[stream]);
            let scaled = over_stated(&self.context, stream, &residual[stream], sd, usable);
            let stated = is_stated(self.context.device, self.context.streams[stream].channel);
            let Some(slow) = with_memory(&scaled, &self.context.runs, stated) else {
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
    pub(crate) fn part(&self, seen: &dyn Fn(usize) -> bool) -> Result<Part, DiagnosisError> {
        let usable: Vec<Vec<bool>> = self
            .usable
            .iter()
            .map(|rows| {
                let rows = rows.iter().enumerate();
                rows.map(|(row, usable)| *usable && seen(row)).collect()
            })
            .collect();
        let blocks = Blocks::new(&self.context, &usable, &self.scale, &self.own, &self.noise);
        let derivatives = self.derivatives.as_ref();
        Part::new(&self.context, &self.problem, blocks, derivatives, self.base)
    }

    /// Whitened derivatives of the base model's free parameters.
    pub(crate) fn free(&self) -> &SparseColumns {
        &self.whole.free
    }

    /// Root mean square change of the base model's predictions from its own fit to another, whose residuals
    /// are given, in noise deviations.
    pub(crate) fn moved(&self, there: &[Vec<f64>]) -> f64 {
        let change: Vec<Vec<f64>> = there
            .iter()
            .zip(&self.start.residual)
            .map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b).collect())
            .collect();
        root_mean_square(&compress_rows(&self.system.layout, &change))
    }

    /// Squared residuals of the base model's own fit, in stated standard deviations.
    pub(crate) fn misfit(&self) -> f64 {
        let streams = self.start.residual.iter().zip(&self.problem.sd);
        let scaled = streams.flat_map(|(residual, sd)| residual.iter().zip(sd));
        let known = scaled.filter(|(residual, _)| residual.is_finite());
        known.map(|(residual, sd)| (residual / sd).powi(2)).sum()
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
    ) -> Result<Vec<Vec<f64>>, DiagnosisError> {
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
