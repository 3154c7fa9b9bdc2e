//! One recording made ready for questions: base model fitted, outliers out, noise known, blocks cut.

use std::sync::Arc;

use haptical_calibration::{Channel, Weights};
use haptical_identification::Matrix;
use haptical_model::Recording;

use crate::DiagnosisError;
use crate::base::{Base, BaseProblem};
use crate::blocks::Blocks;
use crate::catalogue::Effect;
use crate::cleaning::outlying_rows;
use crate::context::{Context, Stream, streams};
use crate::measured::{KnownNoise, estimate_noise, floors, is_stated};
use crate::model::{Cause, Model, Refit};
use crate::noise::Noise;
use crate::part::{Part, root_mean_square, square};
use crate::refit::{HALVINGS, SMALL_STEP};
use crate::system::{System, compress_matrix, compress_rows};

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
    matrix: Option<Matrix>,
    /// What refits are made with.
    pub(crate) whole: Part,
    /// The base model alone.
    pub(crate) start: Refit,
}

/// Passes of the base model's own refit.
const BASE_PASSES: usize = 3;

/// A recording with the base model's residuals and derivatives, before anything is fitted to it.
#[derive(Debug)]
pub(crate) struct Prepared<'a> {
    context: Context<'a>,
    problem: BaseProblem<'a>,
    base: &'a Base,
    own: Vec<f64>,
    usable: Vec<Vec<bool>>,
    matrix: Option<Matrix>,
    residual: Vec<Vec<f64>>,
}

impl<'a> Prepared<'a> {
    /// Evaluates the base model on a recording.
    pub(crate) fn new(base: &'a Base, recording: &'a Recording) -> Result<Self, DiagnosisError> {
        let weights = Weights::stated(&base.device, &base.channels);
        let streams = streams(&base.device, &base.channels);
        let (context, evaluated) = rayon::join(
            || Context::new(&base.device, recording, &streams),
            || {
                let problem = BaseProblem::new(base, recording, &streams, &weights)?;
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
        Ok(Self {
            context: context?,
            problem,
            base,
            own,
            usable,
            matrix: first.matrix,
            residual: first.residual,
        })
    }

    /// Readings that stand alone.
    pub(crate) fn outlying(&self, limit: f64) -> Vec<(Channel, usize)> {
        outlying_rows(&self.context, &self.problem, &self.residual, limit)
    }

    /// Readings that stand alone once causes are in the model.
    pub(crate) fn outlying_beside(
        &self,
        effects: &[Box<dyn Effect>],
        model: &Model,
        limit: f64,
    ) -> Result<Vec<(Channel, usize)>, DiagnosisError> {
        let residual = self.problem.evaluate(&model.values, false)?.residual;
        let residual = beside(residual, &self.context, effects, &model.causes);
        Ok(outlying_rows(
            &self.context,
            &self.problem,
            &residual,
            limit,
        ))
    }

    /// The same recording after some of its readings were taken out, `cleaned`.
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
    pub(crate) fn fit(self, known: Option<&KnownNoise>) -> Result<Engine<'a>, DiagnosisError> {
        let Self {
            context,
            problem,
            base,
            own,
            usable,
            matrix,
            residual,
        } = self;
        let readings: usize = usable.iter().flatten().filter(|usable| **usable).count();
        if readings <= base.free.len() + 4 {
            return Err(DiagnosisError::TooFewReadings {
                readings,
                parameters: base.free.len(),
                advised: 20 * base.free.len().max(5),
            });
        }
        let raw = Raw {
            context: &context,
            problem: &problem,
            base,
            usable: &usable,
            own: &own,
            matrix: matrix.as_ref(),
        };
        let fitted = raw.fit(residual, known)?;
        let BaseFit {
            noise,
            scale,
            whole,
            values,
            residual,
            last_step,
        } = fitted;
        let floor = floors(&problem, &noise, &usable);
        let held: Vec<usize> = (0..base.parameters.len())
            .filter(|parameter| !base.free.contains(parameter))
            .collect();
        let other = matrix
            .as_ref()
            .map(|matrix| compress_matrix(&context, &problem, &whole.blocks, matrix, &held));
        let system = System::new(&context, &whole, other.as_ref(), &residual);
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
            matrix,
            whole,
            start: Refit {
                model: Model {
                    values,
                    bare: Arc::new(residual.clone()),
                    causes: Vec::new(),
                },
                residual,
                covariance: None,
                last_step,
            },
        })
    }
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
        let matrix = self.matrix.as_ref();
        Part::new(
            &self.context,
            &self.problem,
            blocks,
            matrix,
            &self.base.free,
        )
    }

    /// Whitened derivatives of the base model's free parameters.
    pub(crate) fn free(&self) -> &Matrix {
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
        let whitened = compress_rows(&self.system.blocks, &change);
        let square: f64 = whitened.iter().map(|value| value * value).sum();
        (square / whitened.len().max(1) as f64).sqrt()
    }

    /// Residuals of a model of another recording at every row of this one.
    pub(crate) fn residual_of(
        &self,
        effects: &[Box<dyn Effect>],
        values: &[f64],
        causes: &[Cause],
    ) -> Result<Vec<Vec<f64>>, DiagnosisError> {
        let bare = self.problem.evaluate(values, false)?.residual;
        Ok(beside(bare, &self.context, effects, causes))
    }

    /// Residuals of a model of this recording.
    pub(crate) fn residual(&self, effects: &[Box<dyn Effect>], model: &Model) -> Vec<Vec<f64>> {
        beside(model.bare.to_vec(), &self.context, effects, &model.causes)
    }
}

/// Residuals once the causes are in the model.
fn beside(
    mut residual: Vec<Vec<f64>>,
    context: &Context<'_>,
    effects: &[Box<dyn Effect>],
    causes: &[Cause],
) -> Vec<Vec<f64>> {
    for cause in causes {
        for (stream, values) in &cause.contribution(effects, context).parts {
            for (entry, value) in residual[*stream].iter_mut().zip(values) {
                *entry -= value;
            }
        }
    }
    residual
}

/// Values and residuals after a step of the base model, shortened until the cost falls; none where it
/// never does.
fn base_step(
    problem: &BaseProblem<'_>,
    part: &Part,
    base: &Base,
    values: &[f64],
    step: &[f64],
    cost: f64,
) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
    let mut share = 1.0;
    for _ in 0..HALVINGS {
        let mut next = values.to_vec();
        for (&parameter, change) in base.free.iter().zip(step) {
            next[parameter] += share * change;
        }
        if let Ok(evaluated) = problem.evaluate(&next, false)
            && square(part, &evaluated.residual) < cost
        {
            return Some((next, evaluated.residual));
        }
        share *= 0.4;
    }
    None
}

/// A recording with what a base fit needs of it.
struct Raw<'r> {
    context: &'r Context<'r>,
    problem: &'r BaseProblem<'r>,
    base: &'r Base,
    usable: &'r [Vec<bool>],
    own: &'r [f64],
    matrix: Option<&'r Matrix>,
}

/// Outcome of a base fit.
struct BaseFit {
    noise: Vec<Noise>,
    scale: Vec<Option<Vec<f64>>>,
    whole: Part,
    values: Vec<f64>,
    residual: Vec<Vec<f64>>,
    last_step: f64,
}

impl Raw<'_> {
    /// Fits the base model by Gauss-Newton; the noise is estimated anew when the first steps were large.
    fn fit(
        &self,
        mut residual: Vec<Vec<f64>>,
        known: Option<&KnownNoise>,
    ) -> Result<BaseFit, DiagnosisError> {
        let mut values = self.problem.start();
        let mut pass = 0;
        loop {
            let (noise, scale) = match known {
                Some(known) => (known.noise.clone(), known.scale.clone()),
                None => estimate_noise(
                    self.context,
                    self.problem,
                    &residual,
                    self.usable,
                    self.own,
                    self.base.free.len(),
                ),
            };
            let blocks = Blocks::new(self.context, self.usable, &scale, self.own, &noise);
            let free = &self.base.free;
            let whole = Part::new(self.context, self.problem, blocks, self.matrix, free)?;
            let mut last_step: f64 = 0.0;
            // several steps with one decomposition
            for _ in 0..BASE_PASSES {
                let Some(basis) = &whole.basis else {
                    break;
                };
                let step = basis.solve(&compress_rows(&whole.blocks, &residual))?;
                last_step = root_mean_square(&whole.free.times(&step)?);
                if last_step < SMALL_STEP {
                    break;
                }
                let cost = square(&whole, &residual);
                match base_step(self.problem, &whole, self.base, &values, &step, cost) {
                    Some((next, rest)) => (values, residual) = (next, rest),
                    None => break,
                }
            }
            pass += 1;
            // a start far away has shown noise that is partly the step's
            if pass > 1 || last_step < 10.0 * SMALL_STEP {
                return Ok(BaseFit {
                    noise,
                    scale,
                    whole,
                    values,
                    residual,
                    last_step,
                });
            }
        }
    }
}
