//! One recording made ready for questions: base model fitted, outliers out, noise known, blocks cut.

use haptical_calibration::{Channel, Weights};
use haptical_identification::{Matrix, Reduction};
use haptical_linalg::{OrthonormalBasis, RANK_TOLERANCE};
use haptical_model::{Device, Recording};

use rayon::prelude::*;

use crate::DiagnosisError;
use crate::base::{Base, BaseProblem};
use crate::blocks::Blocks;
use crate::catalogue::Effect;
use crate::context::{Context, streams};
use crate::noise::{self, Noise};
use crate::scan::Score;
use crate::signal::Signal;
use crate::system::{System, compress_matrix, compress_rows, dot};

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
    /// The sensors' own stated deviations, per stream.
    own: Vec<f64>,
    /// What the speed makes of them at each row, where it does.
    scale: Vec<Option<Vec<f64>>>,
    /// Derivatives of all parameters at every row.
    matrix: Option<Matrix>,
    /// What refits are made with.
    whole: Part,
    /// The base model alone.
    pub(crate) start: Refit,
}

/// Noise that is known from an earlier look.
#[derive(Debug, Clone)]
pub(crate) struct KnownNoise {
    pub(crate) noise: Vec<Noise>,
    scale: Vec<Option<Vec<f64>>>,
}

/// Rows that a fit sees: their blocks, and the base model's derivatives on them.
#[derive(Debug, Clone)]
pub(crate) struct Part {
    blocks: Blocks,
    /// Compressed derivatives of the free parameters.
    free: Matrix,
    /// Their decomposition; none without parameters.
    basis: Option<OrthonormalBasis>,
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
    /// Prepares a recording.
    pub(crate) fn new(
        base: &'a Base,
        recording: &'a Recording,
        known: Option<&KnownNoise>,
    ) -> Result<Self, DiagnosisError> {
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
        let context = context?;
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
        let usable: Vec<Vec<bool>> = first
            .residual
            .iter()
            .map(|rows| rows.iter().map(|value| value.is_finite()).collect())
            .collect();
        let readings: usize = usable.iter().flatten().filter(|usable| **usable).count();
        let too_few = DiagnosisError::TooFewReadings {
            readings,
            parameters: base.free.len(),
            advised: 20 * base.free.len().max(5),
        };
        if readings <= base.free.len() + 4 {
            return Err(too_few);
        }
        let matrix = first.matrix;
        let mut values = problem.start();
        let mut residual = first.residual;
        let mut prepared = None;
        for pass in 0..BASE_PASSES {
            let (noise, scale) = match known {
                Some(known) => (known.noise.clone(), known.scale.clone()),
                None => estimate_noise(
                    &context,
                    &problem,
                    &residual,
                    &usable,
                    &own,
                    base.free.len(),
                ),
            };
            let blocks = Blocks::new(&context, &usable, &scale, &own, &noise);
            let part = Part::new(&context, &problem, blocks, matrix.as_ref(), &base.free)?;
            let mut size: f64 = 0.0;
            // several steps with one decomposition
            for _ in 0..BASE_PASSES {
                let Some(basis) = &part.basis else {
                    break;
                };
                let step = basis.solve(&compress_rows(&part.blocks, &residual))?;
                size = root_mean_square(&part.free.times(&step)?);
                if size < SMALL_STEP {
                    break;
                }
                let cost = square(&part, &residual);
                let Some((next, rest)) = base_step(&problem, &part, base, &values, &step, cost)
                else {
                    break;
                };
                (values, residual) = (next, rest);
            }
            prepared = Some((noise, scale, part, size));
            // a start far away has shown noise that is partly the step's
            if pass > 0 || size < 10.0 * SMALL_STEP {
                break;
            }
        }
        let Some((noise, scale, whole, last_step)) = prepared else {
            return Err(too_few);
        };
        let floor = floors(&problem, &noise, &usable);
        let everything = matrix
            .as_ref()
            .map(|matrix| compress_matrix(&context, &problem, &whole.blocks, matrix, None));
        let system = System::new(
            &context,
            whole.blocks.clone(),
            everything.as_ref(),
            &residual,
        )?;
        Ok(Self {
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
                    causes: Vec::new(),
                },
                residual,
                covariance: None,
                last_step,
            },
        })
    }

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

    /// Refits base model and causes together on all rows.
    pub(crate) fn refit(
        &self,
        effects: &[Box<dyn Effect>],
        model: &Model,
    ) -> Result<Refit, DiagnosisError> {
        self.refit_on(&self.whole, effects, model)
    }

    /// Refits base model and causes together by Gauss-Newton from `model`, with shorter steps where a
    /// whole one overshoots. The base model's derivatives are those of its own fit until a step calls
    /// for new ones. The causes' columns are projected across the base model's directions, which gives
    /// their steps and covariance; what they leave gives the base model's step.
    pub(crate) fn refit_on(
        &self,
        part: &Part,
        effects: &[Box<dyn Effect>],
        model: &Model,
    ) -> Result<Refit, DiagnosisError> {
        let mut model = model.clone();
        let mut residual = self.residual_of(effects, &model)?;
        let mut cost = square(part, &residual);
        let mut covariance = None;
        let mut last_step = f64::INFINITY;
        let mut refreshed: Option<Part> = None;
        for pass in 0..PASSES {
            let current = refreshed.as_ref().unwrap_or(part);
            let (columns, owners) = self.cause_columns(current, effects, &model);
            let target = compress_rows(&current.blocks, &residual);
            let step = current.step(&columns, &target)?;
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
        let matrix = self.problem.evaluate(values, true)?.matrix;
        let blocks = part.blocks.clone();
        Part::new(
            &self.context,
            &self.problem,
            blocks,
            matrix.as_ref(),
            &self.base.free,
        )
    }

    /// The model after a step, halved until the cost falls; none where it never does.
    fn shortened(
        &self,
        part: &Part,
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
                let square = square(part, &residual);
                if square < cost {
                    return Some((next, residual, square));
                }
            }
            share *= 0.4;
        }
        None
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
            if effect.shape_is_continuous() {
                let step = 0.02;
                let at = |shape: f64| effect.contribution(&self.context, &cause.amplitudes, shape);
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

/// A Gauss-Newton step of base model and causes.
struct Step {
    /// Free parameters, then the causes' numbers.
    values: Vec<f64>,
    /// Root mean square change of the predictions, in noise deviations.
    size: f64,
    /// Squared residual that the linear model loses.
    explained: f64,
    /// Of the causes' numbers.
    covariance: Option<Matrix>,
}

impl Part {
    fn new(
        context: &Context<'_>,
        problem: &BaseProblem<'_>,
        blocks: Blocks,
        matrix: Option<&Matrix>,
        free: &[usize],
    ) -> Result<Self, DiagnosisError> {
        let Some(matrix) = matrix.filter(|_| !free.is_empty()) else {
            return Ok(Self {
                free: Matrix::zeros(blocks.count(), 0),
                basis: None,
                blocks,
            });
        };
        let free = compress_matrix(context, problem, &blocks, matrix, Some(free));
        let basis = Some(OrthonormalBasis::new(&free, RANK_TOLERANCE)?);
        Ok(Self {
            blocks,
            free,
            basis,
        })
    }

    fn step(&self, columns: &[Vec<f64>], target: &[f64]) -> Result<Step, DiagnosisError> {
        let across = |vector: &[f64]| {
            let mut rest = vector.to_vec();
            if let Some(basis) = &self.basis {
                let directions = basis.directions();
                for _ in 0..2 {
                    for k in 0..directions.columns() {
                        let direction = directions.column(k);
                        let shared = dot(direction, &rest);
                        for (entry, other) in rest.iter_mut().zip(direction) {
                            *entry -= shared * other;
                        }
                    }
                }
            }
            rest
        };
        let mut left = target.to_vec();
        let mut numbers = Vec::new();
        let mut covariance = None;
        if !columns.is_empty() {
            let projected: Vec<Vec<f64>> = columns.iter().map(|column| across(column)).collect();
            let matrix = Matrix::from_fn(target.len(), columns.len(), |row, column| {
                projected[column][row]
            });
            let reduction = Reduction::new(&matrix, target)?;
            let all: Vec<usize> = (0..columns.len()).collect();
            numbers = reduction.solve(&all, 0.0, RANK_TOLERANCE)?.values;
            covariance = reduction.covariance(&all, RANK_TOLERANCE).ok();
            for (column, number) in columns.iter().zip(&numbers) {
                for (entry, value) in left.iter_mut().zip(column) {
                    *entry -= number * value;
                }
            }
        }
        let mut values = match &self.basis {
            Some(basis) => basis.solve(&left)?,
            None => Vec::new(),
        };
        if !values.is_empty() {
            let moved = self.free.times(&values)?;
            for (entry, value) in left.iter_mut().zip(&moved) {
                *entry -= value;
            }
        }
        let moved: Vec<f64> = target.iter().zip(&left).map(|(a, b)| a - b).collect();
        values.extend(&numbers);
        Ok(Step {
            values,
            size: root_mean_square(&moved),
            explained: dot(target, target) - dot(&left, &left),
            covariance,
        })
    }
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

fn square(part: &Part, rows: &[Vec<f64>]) -> f64 {
    let whitened = compress_rows(&part.blocks, rows);
    dot(&whitened, &whitened)
}

fn root_mean_square(values: &[f64]) -> f64 {
    (dot(values, values) / values.len().max(1) as f64).sqrt()
}

fn dense(part: &Part, signal: &Signal) -> Vec<f64> {
    let mut dense = vec![0.0; part.blocks.count()];
    for (stream, values) in &signal.parts {
        let compressed = part.blocks.compress(*stream, |row| values[row]);
        dense[part.blocks.range(*stream)].copy_from_slice(&compressed);
    }
    dense
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

fn estimate_noise(
    context: &Context<'_>,
    problem: &BaseProblem<'_>,
    residual: &[Vec<f64>],
    usable: &[Vec<bool>],
    own: &[f64],
    parameters: usize,
) -> (Vec<Noise>, Vec<Option<Vec<f64>>>) {
    let lost = parameters as f64 / context.streams.len().max(1) as f64;
    (0..context.streams.len())
        .into_par_iter()
        .map(|stream| {
            let mut scaled: Vec<f64> = (0..context.rows())
                .map(|row| {
                    if usable[stream][row] {
                        residual[stream][row] / problem.sd[stream][row]
                    } else {
                        f64::NAN
                    }
                })
                .collect();
            let by_speed = speed_of(context, stream)
                .and_then(|speed| noise::speed_scale(&scaled, &speed, &context.runs));
            if let Some((scale, _)) = &by_speed {
                for (value, scale) in scaled.iter_mut().zip(scale) {
                    *value /= scale;
                }
            }
            let stated = is_stated(context.device, context.streams[stream].channel);
            let rounding = if stated {
                rounding_share(&problem.sd[stream], own[stream], &usable[stream])
            } else {
                0.0
            };
            let mut found = noise::estimate(
                &scaled,
                &context.runs,
                context.ordered,
                lost,
                stated,
                rounding,
            )
            .with_rounding(rounding);
            found.speed_ratio = by_speed.as_ref().map_or(1.0, |(_, ratio)| *ratio);
            (found, by_speed.map(|(scale, _)| scale))
        })
        .unzip()
}

/// Speed of what a stream measures, where rows follow a motion in time.
fn speed_of(context: &Context<'_>, stream: usize) -> Option<Vec<f64>> {
    let motion = context.motion.as_ref().filter(|_| context.ordered)?;
    match context.streams[stream].channel {
        Channel::Output { joint } => Some(motion[joint].velocity.clone()),
        Channel::Cable { index: 0 } => Some(context.cable.as_ref()?.motion.velocity.clone()),
        _ => None,
    }
}

/// Share of a stream's stated variance that the rounding of the motor encoders has.
fn rounding_share(sd: &[f64], own: f64, usable: &[bool]) -> f64 {
    let squares = sd.iter().zip(usable).filter(|(_, usable)| **usable);
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), (sd, _)| {
        (sum + sd * sd, count + 1.0)
    });
    if sum > 0.0 {
        (1.0 - own * own * count / sum).max(0.0)
    } else {
        0.0
    }
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
