//! One recording made ready for questions: base model fitted, outliers out, noise known, blocks cut.

use haptical_calibration::{Channel, Weights};
use haptical_identification::{Matrix, Reduction};
use haptical_linalg::RANK_TOLERANCE;
use haptical_model::{Device, Recording};

use crate::DiagnosisError;
use crate::base::{Base, BaseProblem};
use crate::blocks::Blocks;
use crate::catalogue::Effect;
use crate::context::Context;
use crate::noise::{self, Noise};
use crate::scan::Score;
use crate::signal::Signal;
use crate::system::{System, compress_matrix, compress_rows};

/// A cause with its fitted numbers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cause {
    /// Position in the catalogue.
    pub(crate) effect: usize,
    pub(crate) amplitudes: Vec<f64>,
    pub(crate) shape: f64,
    /// Of an event: one instant for each amplitude.
    pub(crate) times: Vec<f64>,
}

impl Cause {
    /// A scored effect as a cause.
    pub(crate) fn of(score: &Score) -> Self {
        Self {
            effect: score.effect,
            amplitudes: score.amplitudes.clone(),
            shape: score.shape,
            times: score.times.clone(),
        }
    }

    /// Derivatives with respect to its amplitudes.
    pub(crate) fn derivative(
        &self,
        effects: &[Box<dyn Effect>],
        context: &Context<'_>,
    ) -> Vec<Signal> {
        let effect = effects[self.effect].as_ref();
        if self.times.is_empty() {
            return effect.derivative(context, &self.amplitudes, self.shape);
        }
        self.times
            .iter()
            .flat_map(|&time| effect.derivative(context, &[0.0], time))
            .collect()
    }

    /// What it adds to the streams.
    pub(crate) fn contribution(
        &self,
        effects: &[Box<dyn Effect>],
        context: &Context<'_>,
    ) -> Signal {
        let effect = effects[self.effect].as_ref();
        if self.times.is_empty() {
            return effect.contribution(context, &self.amplitudes, self.shape);
        }
        let mut sum = Signal::default();
        for (&time, amplitude) in self.times.iter().zip(&self.amplitudes) {
            sum.add(&effect.contribution(context, &[*amplitude], time), 1.0);
        }
        sum
    }
}

/// Values of the base model's parameters with the causes found.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Model {
    pub(crate) values: Vec<f64>,
    pub(crate) causes: Vec<Cause>,
}

/// A fit of base model and causes together.
#[derive(Debug, Clone)]
pub(crate) struct Refit {
    pub(crate) model: Model,
    /// Measured minus model and causes, per stream and row.
    pub(crate) residual: Vec<Vec<f64>>,
    /// Covariance of all amplitudes (causes in order, each with its shape last where that is
    /// continuous), for noise of the estimated size.
    pub(crate) covariance: Option<Matrix>,
    /// Largest step of the last iteration, in standard deviations of the residuals.
    pub(crate) last_step: f64,
}

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
    /// Compressed derivatives of the free parameters.
    free: Matrix,
    /// The base model alone.
    pub(crate) start: Refit,
}

/// Passes of the base model's own refit.
const BASE_PASSES: usize = 3;
/// A step that changes no prediction by more than this share of the noise ends a refit.
const SMALL_STEP: f64 = 0.02;
/// Passes of a refit with causes.
const PASSES: usize = 7;
/// Shorter steps that are tried where a step does not lower the cost.
const HALVINGS: usize = 5;

impl<'a> Engine<'a> {
    /// Prepares a recording. `rows` says which rows the fit may see.
    pub(crate) fn new(
        base: &'a Base,
        recording: &'a Recording,
        seen: &dyn Fn(usize) -> bool,
        known_noise: Option<&[Noise]>,
    ) -> Result<Self, DiagnosisError> {
        let weights = Weights::stated(&base.device, &base.channels);
        let context = Context::new(&base.device, recording, &base.channels)?;
        let problem = BaseProblem::new(base, recording, &context.streams, &weights)?;
        let own: Vec<f64> = context
            .streams
            .iter()
            .map(|stream| {
                weights
                    .channel_sd
                    .get(&stream.channel)
                    .copied()
                    .unwrap_or(1e-4)
            })
            .collect();
        let mut values = problem.start();
        let first = problem.evaluate(&values, true)?;
        let matrix = first.matrix;
        let usable: Vec<Vec<bool>> = first
            .residual
            .iter()
            .map(|rows| {
                rows.iter()
                    .enumerate()
                    .map(|(row, value)| value.is_finite() && seen(row))
                    .collect()
            })
            .collect();
        let readings: usize = usable.iter().flatten().filter(|usable| **usable).count();
        if readings <= base.free.len() + 4 {
            return Err(DiagnosisError::TooFewReadings {
                readings,
                parameters: base.free.len(),
                advised: 20 * base.free.len().max(5),
            });
        }
        let mut residual = first.residual;
        let mut noise = Vec::new();
        let mut prepared = None;
        for _ in 0..BASE_PASSES {
            noise = match known_noise {
                Some(known) => known.to_vec(),
                None => estimate_noise(&context, &problem, &residual, &usable, base.free.len()),
            };
            let blocks = Blocks::new(&context, &usable, &problem.sd, &own, &noise);
            let free = free_columns(&context, &problem, &blocks, matrix.as_ref(), &base.free);
            let step = if free.columns() == 0 {
                0.0
            } else {
                let target = compress_rows(&blocks, &residual);
                let step = base_step(&free, &target)?;
                for (&parameter, change) in base.free.iter().zip(&step) {
                    values[parameter] += change;
                }
                let moved = free.times(&step)?;
                let size = moved.iter().map(|m| m * m).sum::<f64>() / moved.len().max(1) as f64;
                residual = problem.evaluate(&values, false)?.residual;
                size.sqrt()
            };
            prepared = Some((blocks, free, step));
            if step < SMALL_STEP {
                break;
            }
        }
        let Some((blocks, free, last_step)) = prepared else {
            return Err(DiagnosisError::TooFewReadings {
                readings,
                parameters: base.free.len(),
                advised: 100,
            });
        };
        let floor = floors(&problem, &noise, &usable);
        let system = System::new(&context, &problem, blocks, matrix.as_ref(), &residual)?;
        Ok(Self {
            context,
            problem,
            base,
            noise,
            floor,
            usable,
            system,
            free,
            start: Refit {
                model: Model {
                    values,
                    causes: Vec::new(),
                },
                residual,
                covariance: None,
                last_step,
            },
        })
    }

    /// Whitened derivatives of the base model's free parameters.
    pub(crate) fn free(&self) -> &Matrix {
        &self.free
    }

    /// Root mean square change of the base model's predictions from its own fit to other values, in
    /// noise deviations.
    pub(crate) fn moved(&self, values: &[f64]) -> Result<f64, DiagnosisError> {
        let there = self.problem.evaluate(values, false)?.residual;
        let change: Vec<Vec<f64>> = there
            .iter()
            .zip(&self.start.residual)
            .map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b).collect())
            .collect();
        let whitened = compress_rows(&self.system.blocks, &change);
        let square: f64 = whitened.iter().map(|value| value * value).sum();
        Ok((square / whitened.len().max(1) as f64).sqrt())
    }

    /// What causes add to every stream.
    pub(crate) fn contribution(&self, effects: &[Box<dyn Effect>], causes: &[Cause]) -> Signal {
        let mut sum = Signal::default();
        for cause in causes {
            sum.add(&cause.contribution(effects, &self.context), 1.0);
        }
        sum
    }

    /// Residuals of a model at every row.
    pub(crate) fn residual_of(
        &self,
        effects: &[Box<dyn Effect>],
        model: &Model,
    ) -> Result<Vec<Vec<f64>>, DiagnosisError> {
        let mut residual = self.problem.evaluate(&model.values, false)?.residual;
        for (stream, values) in &self.contribution(effects, &model.causes).parts {
            for (entry, value) in residual[*stream].iter_mut().zip(values) {
                *entry -= value;
            }
        }
        Ok(residual)
    }

    /// Refits base model and causes together by Gauss-Newton from `model`, with shorter steps where a
    /// whole one overshoots. The base model's derivatives are those of its own fit until a step calls
    /// for new ones.
    pub(crate) fn refit(
        &self,
        effects: &[Box<dyn Effect>],
        model: &Model,
    ) -> Result<Refit, DiagnosisError> {
        let mut model = model.clone();
        let mut residual = self.residual_of(effects, &model)?;
        let mut cost = self.square(&residual);
        let mut covariance = None;
        let mut last_step = f64::INFINITY;
        let mut refreshed: Option<Matrix> = None;
        for pass in 0..PASSES {
            let free = refreshed.as_ref().unwrap_or(&self.free);
            let (matrix, owners) = self.stacked(effects, &model, free);
            let target = compress_rows(&self.system.blocks, &residual);
            let reduction = Reduction::new(&matrix, &target)?;
            let all: Vec<usize> = (0..matrix.columns()).collect();
            let solution = reduction.solve(&all, 0.0, RANK_TOLERANCE)?;
            covariance = reduction
                .covariance(&all, RANK_TOLERANCE)
                .ok()
                .or(covariance);
            let moved = matrix.times(&solution.values)?;
            last_step =
                (moved.iter().map(|m| m * m).sum::<f64>() / moved.len().max(1) as f64).sqrt();
            if last_step < SMALL_STEP {
                break;
            }
            let taken = self.shortened(effects, &model, &owners, &solution.values, cost);
            let is_slow = match taken {
                Some((next, rest, less)) => {
                    let gain = cost - less;
                    model = next;
                    residual = rest;
                    let is_slow = gain < 0.5 * solution.explained_square.max(0.0);
                    cost = less;
                    is_slow
                }
                None => true,
            };
            if is_slow || pass == 1 {
                if refreshed.is_some() && is_slow && pass > 2 {
                    break;
                }
                refreshed = Some(self.free_at(&model.values)?);
            }
        }
        let first = self.free.columns();
        let covariance = covariance.map(|full| {
            let size = full.columns() - first;
            Matrix::from_fn(size, size, |a, b| full[(first + a, first + b)])
        });
        Ok(Refit {
            model,
            residual,
            covariance,
            last_step,
        })
    }

    fn square(&self, rows: &[Vec<f64>]) -> f64 {
        let whitened = compress_rows(&self.system.blocks, rows);
        whitened.iter().map(|value| value * value).sum()
    }

    /// The model after a step, halved until the cost falls; none where it never does.
    fn shortened(
        &self,
        effects: &[Box<dyn Effect>],
        model: &Model,
        owners: &[Owner],
        step: &[f64],
        cost: f64,
    ) -> Option<(Model, Vec<Vec<f64>>, f64)> {
        let mut share = 1.0;
        for _ in 0..HALVINGS {
            let mut next = model.clone();
            for (&parameter, change) in self.base.free.iter().zip(step) {
                next.values[parameter] += share * change;
            }
            for (owner, change) in owners.iter().zip(&step[self.base.free.len()..]) {
                apply(&mut next.causes, *owner, share * change);
            }
            if let Ok(residual) = self.residual_of(effects, &next) {
                let square = self.square(&residual);
                if square < cost {
                    return Some((next, residual, square));
                }
            }
            share *= 0.4;
        }
        None
    }

    /// The base model's free derivatives at other values.
    fn free_at(&self, values: &[f64]) -> Result<Matrix, DiagnosisError> {
        let matrix = self.problem.evaluate(values, true)?.matrix;
        Ok(free_columns(
            &self.context,
            &self.problem,
            &self.system.blocks,
            matrix.as_ref(),
            &self.base.free,
        ))
    }

    /// Derivatives of base model and causes side by side.
    fn stacked(
        &self,
        effects: &[Box<dyn Effect>],
        model: &Model,
        free: &Matrix,
    ) -> (Matrix, Vec<Owner>) {
        let (columns, owners) = self.cause_columns(effects, model);
        let width = free.columns() + columns.len();
        let mut matrix = Matrix::zeros(self.system.blocks.count(), width);
        for column in 0..free.columns() {
            matrix
                .column_mut(column)
                .copy_from_slice(free.column(column));
        }
        for (index, column) in columns.iter().enumerate() {
            matrix
                .column_mut(free.columns() + index)
                .copy_from_slice(column);
        }
        (matrix, owners)
    }

    /// Whitened derivatives of all causes' numbers, with whose they are.
    fn cause_columns(
        &self,
        effects: &[Box<dyn Effect>],
        model: &Model,
    ) -> (Vec<Vec<f64>>, Vec<Owner>) {
        let mut columns = Vec::new();
        let mut owners = Vec::new();
        for (index, cause) in model.causes.iter().enumerate() {
            let effect = &effects[cause.effect];
            let signals = cause.derivative(effects, &self.context);
            for (amplitude, signal) in signals.iter().enumerate() {
                columns.push(self.dense(signal));
                owners.push(Owner::Amplitude(index, amplitude));
            }
            if effect.shape_is_continuous() {
                let step = 0.02;
                let at = |shape: f64| effect.contribution(&self.context, &cause.amplitudes, shape);
                let mut slope = at(cause.shape * (1.0 + step));
                slope.add(&at(cause.shape * (1.0 - step)), -1.0);
                let mut dense = self.dense(&slope);
                dense.iter_mut().for_each(|entry| *entry /= 2.0 * step);
                columns.push(dense);
                owners.push(Owner::LogShape(index));
            }
        }
        (columns, owners)
    }

    fn dense(&self, signal: &Signal) -> Vec<f64> {
        let mut dense = vec![0.0; self.system.blocks.count()];
        for (stream, values) in &self.system.column(signal).parts {
            dense[self.system.blocks.range(*stream)].copy_from_slice(values);
        }
        dense
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

fn free_columns(
    context: &Context<'_>,
    problem: &BaseProblem<'_>,
    blocks: &Blocks,
    matrix: Option<&Matrix>,
    free: &[usize],
) -> Matrix {
    let Some(matrix) = matrix else {
        return Matrix::zeros(blocks.count(), 0);
    };
    let chosen = Matrix::from_fn(matrix.rows(), free.len(), |row, column| {
        matrix.column(free[column])[row]
    });
    compress_matrix(context, problem, blocks, &chosen)
}

fn base_step(free: &Matrix, target: &[f64]) -> Result<Vec<f64>, DiagnosisError> {
    let reduction = Reduction::new(free, target)?;
    let all: Vec<usize> = (0..free.columns()).collect();
    Ok(reduction.solve(&all, 0.0, RANK_TOLERANCE)?.values)
}

fn estimate_noise(
    context: &Context<'_>,
    problem: &BaseProblem<'_>,
    residual: &[Vec<f64>],
    usable: &[Vec<bool>],
    parameters: usize,
) -> Vec<Noise> {
    let lost = parameters as f64 / context.streams.len().max(1) as f64;
    (0..context.streams.len())
        .map(|stream| {
            let scaled: Vec<f64> = (0..context.rows())
                .map(|row| {
                    if usable[stream][row] {
                        residual[stream][row] / problem.sd[stream][row]
                    } else {
                        f64::NAN
                    }
                })
                .collect();
            let stated = is_stated(context.device, context.streams[stream].channel);
            noise::estimate(&scaled, &context.runs, context.ordered, lost, stated)
        })
        .collect()
}

/// Whether the device file says how noisy a channel is.
fn is_stated(device: &Device, channel: Channel) -> bool {
    match channel {
        Channel::Output { joint } => device.joints[joint].output_sd_rad().is_some(),
        Channel::Cable { index } => device.cable_sd_m(index).is_some(),
        Channel::Position => device.tracker.is_some_and(|t| t.position_sd_m.is_some()),
        Channel::Orientation => device.tracker.is_some_and(|t| t.rotation_sd_rad.is_some()),
    }
}

fn floors(problem: &BaseProblem<'_>, noise: &[Noise], usable: &[Vec<bool>]) -> Vec<f64> {
    (0..noise.len())
        .map(|stream| {
            let rows: Vec<f64> = problem.sd[stream]
                .iter()
                .zip(&usable[stream])
                .filter(|(_, usable)| **usable)
                .map(|(sd, _)| sd * sd)
                .collect();
            let mean = rows.iter().sum::<f64>() / rows.len().max(1) as f64;
            noise[stream].ratio * mean.sqrt()
        })
        .collect()
}

/// Rows that stand alone in a channel (any of its axes), by the base model's residuals.
pub(crate) fn outlying_rows(
    context: &Context<'_>,
    problem: &BaseProblem<'_>,
    residual: &[Vec<f64>],
    limit: f64,
) -> Vec<(Channel, usize)> {
    let mut found = Vec::new();
    for (index, stream) in context.streams.iter().enumerate() {
        let scaled: Vec<f64> = residual[index]
            .iter()
            .zip(&problem.sd[index])
            .map(|(value, sd)| value / sd)
            .collect();
        let ratio = if context.ordered {
            noise::difference_sd(&scaled, &context.runs)
        } else {
            spread(&scaled)
        };
        let Some(ratio) = ratio.filter(|ratio| *ratio > 0.0) else {
            continue;
        };
        let rows = noise::outliers(&scaled, &context.runs, context.ordered, ratio, limit);
        found.extend(rows.into_iter().map(|row| (stream.channel, row)));
    }
    found.sort_unstable();
    found.dedup();
    found
}

/// Standard deviation from the median absolute value.
fn spread(scaled: &[f64]) -> Option<f64> {
    let mut sizes: Vec<f64> = scaled
        .iter()
        .filter(|value| value.is_finite())
        .map(|value| value.abs())
        .collect();
    if sizes.is_empty() {
        return None;
    }
    let middle = sizes.len() / 2;
    let (_, median, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
    Some(*median / 0.674_489_750_196_081_7)
}

/// A copy of a recording without some readings.
pub(crate) fn without_readings(recording: &Recording, gone: &[(Channel, usize)]) -> Recording {
    let mut cleaned = recording.clone();
    for &(channel, row) in gone {
        match channel {
            Channel::Output { joint } => {
                if let Some(Some(column)) = cleaned.output.get_mut(joint) {
                    column[row] = f64::NAN;
                }
            }
            Channel::Cable { index } => {
                if let Some(Some(column)) = cleaned.cable_m.get_mut(index) {
                    column[row] = f64::NAN;
                }
            }
            Channel::Position => {
                for column in cleaned.position_m.iter_mut().flatten() {
                    column[row] = f64::NAN;
                }
            }
            Channel::Orientation => {
                for column in cleaned.orientation_wxyz.iter_mut().flatten() {
                    column[row] = f64::NAN;
                }
            }
        }
    }
    cleaned
}
