//! A recording with the base model's residuals, before anything is fitted to it.

use std::sync::Arc;

use haptical_calibration::{Channel, Weights};
use haptical_effects::{Context, Effect, streams};
use haptical_identification::Convergence;
use haptical_linalg::SparseColumns;
use haptical_model::Recording;

use super::{Engine, with_causes};
use crate::DiagnosisError;
use crate::engine::base::Base;
use crate::engine::base::problem::{BaseProblem, Derivatives};
use crate::engine::blocks::Blocks;
use crate::engine::model::{Model, Refit};
use crate::engine::part::Part;
use crate::engine::system::compress_columns;
use crate::noise::Noise;
use crate::noise::measured::{KnownNoise, floors};
use crate::noise::{self, cleaning::outlying_rows};

/// A recording with the base model's residuals and derivatives, before anything is fitted to it.
#[derive(Debug)]
pub(crate) struct Prepared<'a> {
    pub(crate) context: Context<'a>,
    pub(super) problem: BaseProblem<'a>,
    pub(super) base: &'a Base,
    pub(super) own: Vec<f64>,
    pub(super) usable: Vec<Vec<bool>>,
    pub(super) derivatives: Option<Derivatives>,
    pub(super) residual: Vec<Vec<f64>>,
}

/// Outcome of a base fit.
pub(super) struct BaseFit {
    pub(super) noise: Vec<Noise>,
    pub(super) scale: Vec<Option<Vec<f64>>>,
    pub(super) whole: Part,
    pub(super) values: Vec<f64>,
    pub(super) residual: Vec<Vec<f64>>,
    pub(super) promised: f64,
    pub(super) convergence: Convergence,
    pub(super) last_step: f64,
}

impl<'a> Prepared<'a> {
    /// Evaluates the base model on a recording, and everything's derivatives at `postures`, which are its own or near
    /// them.
    pub(crate) fn new(
        base: &'a Base,
        recording: &'a Recording,
        postures: &'a Recording,
    ) -> Result<Self, DiagnosisError> {
        let weights = Weights::stated(&base.device, &base.channels);
        let streams = streams(&base.device, &base.channels);
        let (context, evaluated) = rayon::join(
            || Context::new(&base.device, postures, &streams),
            || {
                let problem = BaseProblem::new(base, recording, postures, &streams, &weights)?;
                let first = problem.evaluate(&problem.start(), true)?;
                Ok::<_, DiagnosisError>((problem, first))
            },
        );
        let (problem, first) = evaluated?;
        let own: Vec<f64> = streams
            .iter()
            .map(|stream| {
                weights
                    .channel_sd
                    .get(&stream.channel)
                    .copied()
                    .unwrap_or(1e-4)
            })
            .collect();
        let usable = first
            .residual
            .iter()
            .map(|rows| rows.iter().map(|value| value.is_finite()).collect())
            .collect();
        let mut context = context?;
        context.lines = noise::lines(&context, &first.residual);
        Ok(Self {
            context,
            problem,
            base,
            own,
            usable,
            derivatives: first.derivatives,
            residual: first.residual,
        })
    }

    /// Sums over a channel's readings of their squared residuals and of their stated variances, and their number.
    pub(crate) fn squares(&self, channel: Channel) -> Option<(f64, f64, f64)> {
        let (mut squares, mut stated, mut count) = (0.0, 0.0, 0.0);
        for (index, _) in (self.context.streams.iter().enumerate())
            .filter(|(_, stream)| stream.channel == channel)
        {
            let pairs = self.residual[index].iter().zip(&self.problem.sd[index]);
            for ((residual, sd), _) in pairs
                .zip(&self.usable[index])
                .filter(|(_, usable)| **usable)
            {
                squares += residual * residual;
                stated += sd * sd;
                count += 1.0;
            }
        }
        (count > 0.0).then_some((squares, stated, count))
    }

    /// The recording in blocks, whitened by a noise that is known from another recording of the same streams, with the
    /// derivatives of all parameters of the base model on them.
    pub(crate) fn whitened(&self, noise: &[Noise]) -> (Blocks, SparseColumns) {
        let scale = vec![None; self.context.streams.len()];
        let blocks = Blocks::new(&self.context, &self.usable, &scale, &self.own, noise);
        let all: Vec<usize> = (0..self.base.parameters.len()).collect();
        let columns = match &self.derivatives {
            Some(derivatives) => {
                compress_columns(&self.context, &self.problem, &blocks, derivatives, &all)
            }
            None => SparseColumns::new(blocks.count(), Vec::new()),
        };
        (blocks, columns)
    }

    /// Readings that stand alone.
    pub(crate) fn outlying(&self, limit: f64) -> Vec<(Channel, usize)> {
        outlying_rows(
            &self.context,
            &self.problem,
            &self.residual,
            &self.own,
            limit,
        )
    }

    /// Readings that stand alone once causes are in the model.
    pub(crate) fn outlying_beside(
        &self,
        effects: &[Box<dyn Effect>],
        model: &Model,
        limit: f64,
    ) -> Result<Vec<(Channel, usize)>, DiagnosisError> {
        let residual = self.problem.evaluate(&model.values, false)?.residual;
        let residual = with_causes(residual, &self.context, effects, &model.causes);
        Ok(outlying_rows(
            &self.context,
            &self.problem,
            &residual,
            &self.own,
            limit,
        ))
    }

    /// The same after some readings were taken out, `cleaned` its postures without them.
    pub(crate) fn without(
        mut self,
        gone: &[(Channel, usize)],
        cleaned: &'a Recording,
    ) -> Prepared<'a> {
        self.context.recording = cleaned;
        for &(channel, row) in gone {
            for (index, stream) in self.context.streams.iter().enumerate() {
                if stream.channel == channel {
                    self.usable[index][row] = false;
                    self.residual[index][row] = f64::NAN;
                    self.problem.forget(index, row);
                }
            }
        }
        self
    }

    /// Fits the base model; the noise is estimated where it is not `known`.
    pub(crate) fn fit(mut self, known: Option<&KnownNoise>) -> Result<Engine<'a>, DiagnosisError> {
        let readings = self.usable.iter().flatten();
        let readings: usize = readings.filter(|usable| **usable).count();
        let free = self.base.free.len();
        if readings <= free + 4 {
            return Err(DiagnosisError::TooFewReadings {
                readings,
                parameters: free,
                advised: 20 * free.max(5),
            });
        }
        let residual = std::mem::take(&mut self.residual);
        let BaseFit {
            noise,
            scale,
            whole,
            values,
            residual,
            promised,
            convergence,
            last_step,
        } = self.base_fit(residual, known)?;
        let Self {
            context,
            problem,
            base,
            own,
            usable,
            derivatives,
            ..
        } = self;
        let floor = floors(&problem, &noise, &usable);
        let held: Vec<usize> = (0..base.parameters.len())
            .filter(|parameter| !base.free.contains(parameter))
            .collect();
        let other = derivatives
            .as_ref()
            .map(|all| compress_columns(&context, &problem, &whole.blocks, all, &held));
        let system = whole.system(&context, other.as_ref(), &residual)?;
        Ok(Engine {
            context,
            problem,
            base,
            noise,
            floor,
            usable,
            system,
            own,
            scale,
            derivatives,
            whole,
            start: Refit {
                model: Model {
                    values,
                    bare: Arc::new(residual.clone()),
                    causes: Vec::new(),
                },
                residual,
                covariance: None,
                promised,
                convergence,
                last_step,
            },
        })
    }
}
