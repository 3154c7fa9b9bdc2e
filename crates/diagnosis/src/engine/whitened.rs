//! Base model and causes on the blocks of a part of the rows, as a least-squares problem.

use std::ops::Range;

use haptical_effects::{Context, Effect, Shape, Signal};
use haptical_identification::{IdentificationError, TriangleProblem};
use haptical_linalg::{Direction, SparseColumns, Triangle};

use super::sampled::Samples;
use crate::DiagnosisError;
use crate::Result;
use crate::engine::{BaseProblem, Cause, Derivatives, Model, Part, Prepared};
use crate::thresholds::engine::WIDTH_STEP;

/// What a fit of base model and causes is made of.
#[derive(Clone, Copy)]
pub(crate) struct Fitting<'r> {
    pub(crate) data: &'r Prepared<'r>,
    pub(crate) effects: &'r [Box<dyn Effect>],
    /// The rows that it sees.
    pub(crate) part: &'r Part,
    /// Share of the cost by which a step of a slow search lowers it at least, where its minimum is only compared with others.
    pub(crate) least_fall: Option<f64>,
}

/// Whitened residuals over the base model's free numbers, then the causes' numbers; of a continuous shape the logarithm is one.
///
/// They are those of all rows at the start; what the base model changes by from there is worked out at samples of the rows.
pub(super) struct Whitened<'f> {
    fitting: &'f Fitting<'f>,
    model: &'f Model,
    owners: Vec<Owner>,
    samples: &'f Samples,
    /// The base model at the samples.
    problem: &'f BaseProblem<'f>,
    /// On all rows less at the samples, of the start without causes.
    offset: Vec<f64>,
}

impl<'f> Whitened<'f> {
    /// The problem at a model whose residuals are known.
    pub(super) fn new(
        fitting: &'f Fitting<'f>,
        model: &'f Model,
        (samples, problem): (&'f Samples, &'f BaseProblem<'f>),
    ) -> Result<Self> {
        let mut made = Self {
            owners: owners(fitting.effects, &model.causes),
            fitting,
            model,
            samples,
            problem,
            offset: vec![0.0; fitting.part.blocks.count()],
        };
        if samples.rows.is_some() {
            let there = problem.evaluate(&model.values, false)?.residual;
            let sampled = made.compressed(&there);
            let all = fitting.part.blocks.compress_rows(&model.bare);
            let pairs = all.iter().zip(sampled);
            made.offset = pairs.map(|(all, sampled)| all - sampled).collect();
        }
        Ok(made)
    }

    /// Whitened blocks of the base model's residuals at samples.
    fn compressed(&self, residual: &[Vec<f64>]) -> Vec<f64> {
        let blocks = &self.fitting.part.blocks;
        let of_stream = |(stream, values): (usize, &Vec<f64>)| {
            self.samples.compress(blocks, stream, |row| values[row])
        };
        residual.iter().enumerate().flat_map(of_stream).collect()
    }

    /// What a model leaves, by the base model's residuals at samples.
    fn left(&self, model: &Model, of_base: &[Vec<f64>]) -> Vec<f64> {
        let mut left = self.compressed(of_base);
        for (entry, offset) in left.iter_mut().zip(&self.offset) {
            *entry += offset;
        }
        let Fitting {
            data,
            effects,
            part,
            ..
        } = *self.fitting;
        for cause in &model.causes {
            let shown = part
                .blocks
                .dense(&cause.contribution(effects, &data.context));
            for (entry, value) in left.iter_mut().zip(shown) {
                *entry -= value;
            }
        }
        left
    }

    /// The numbers of the model that it was made with.
    pub(super) fn start(&self) -> Vec<f64> {
        let base = self.fitting.data.base.free.iter();
        let owners = self.owners.iter();
        let of_causes = owners.map(|owner| owner.number(&self.model.causes));
        base.map(|&place| self.model.values[place])
            .chain(of_causes)
            .collect()
    }

    /// The model of numbers, its residuals still those of the start.
    pub(super) fn model(&self, numbers: &[f64]) -> Model {
        let base = self.fitting.data.base;
        let (free, of_causes) = numbers.split_at(base.free.len());
        let mut model = self.model.clone();
        for (&place, &value) in base.free.iter().zip(free) {
            let parameter = base.parameters[place];
            model.values[place] = parameter.in_nearest_turn(value, parameter.value(&base.device));
        }
        for (owner, &value) in self.owners.iter().zip(of_causes) {
            owner.set(&mut model.causes, value);
        }
        model
    }
}

impl TriangleProblem for Whitened<'_> {
    fn columns(&self) -> usize {
        self.fitting.data.base.free.len() + self.owners.len()
    }

    fn rows(&self) -> usize {
        self.offset.len()
    }

    fn reduce_into(
        &self,
        parameters: &[f64],
        free: &[usize],
        into: &mut Triangle,
    ) -> Result<(), IdentificationError> {
        let failed = |error: DiagnosisError| match error {
            DiagnosisError::Identification(error) => error,
            other => IdentificationError::Evaluation {
                reason: other.to_string(),
            },
        };
        let Fitting { data, part, .. } = *self.fitting;
        let model = self.model(parameters);
        let there = self.problem.evaluate(&model.values, !free.is_empty());
        let there = there.map_err(failed)?;
        let mut residual = self.left(&model, &there.residual);
        // model less measured
        residual.iter_mut().for_each(|entry| *entry = -*entry);
        let columns = match free.is_empty() {
            true => SparseColumns::new(residual.len(), Vec::new()),
            false => self.derivatives(&model, there.derivatives.as_ref(), free),
        };
        let streams = (0..data.context.streams.len()).map(|stream| part.blocks.range(stream));
        fold_parts(&columns, &residual, streams, into)?;
        self.fold_anchors(&model, free, into)
    }
}

impl Whitened<'_> {
    /// Derivatives of the whitened predictions by the `free` numbers, a column each.
    fn derivatives(
        &self,
        model: &Model,
        of_base: Option<&Derivatives>,
        free: &[usize],
    ) -> SparseColumns {
        let Fitting { data, part, .. } = *self.fitting;
        let (blocks, base) = (&part.blocks, &data.base.free);
        let compress = |stream: usize, derivative: &dyn Fn(usize) -> f64| {
            self.samples.compress(blocks, stream, derivative)
        };
        let of_base = of_base.map(|known| self.problem.columns(known, base, blocks, &compress));
        let of_causes = by_cause(self.fitting, model);
        let column = |&number: &usize| match number.checked_sub(base.len()) {
            Some(cause) => Direction::new(of_causes[cause].clone()),
            None => of_base.as_ref().map_or_else(
                || Direction::new(Vec::new()),
                |of_base| of_base.column(number).clone(),
            ),
        };
        SparseColumns::new(blocks.count(), free.iter().map(column).collect())
    }

    /// A row for each anchored number.
    fn fold_anchors(
        &self,
        model: &Model,
        free: &[usize],
        into: &mut Triangle,
    ) -> Result<(), IdentificationError> {
        let base = self.fitting.data.base;
        let pull: Vec<f64> = base.pull(&model.values).iter().map(|pull| -pull).collect();
        let column = |number: &usize| {
            let mut column = vec![0.0; pull.len()];
            if let (Some(entry), Some(stiffness)) =
                (column.get_mut(*number), base.stiffness().get(*number))
            {
                *entry = *stiffness;
            }
            column
        };
        let columns: Vec<Vec<f64>> = free.iter().map(column).collect();
        let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        Ok(into.fold_rows(&columns, &pull)?)
    }
}

/// Folds rows part by part; of a part that knows few columns these alone are reduced, before what is left of it is folded.
fn fold_parts(
    columns: &SparseColumns,
    residual: &[f64],
    parts: impl Iterator<Item = Range<usize>>,
    into: &mut Triangle,
) -> Result<(), IdentificationError> {
    let dense: Vec<Vec<f64>> = (0..columns.columns())
        .map(|column| columns.dense(column))
        .collect();
    for rows in parts {
        let of_rows: Vec<&[f64]> = dense.iter().map(|column| &column[rows.clone()]).collect();
        let known = |column: &usize| of_rows[*column].iter().any(|entry| *entry != 0.0);
        let known: Vec<usize> = (0..dense.len()).filter(known).collect();
        if 2 * known.len() >= dense.len() || rows.len() <= known.len() {
            into.fold_rows(&of_rows, &residual[rows])?;
            continue;
        }
        let mut few = Triangle::new(known.len());
        let of_known: Vec<&[f64]> = known.iter().map(|&column| of_rows[column]).collect();
        few.fold_rows(&of_known, &residual[rows])?;
        let few = few.as_rows();
        let nothing = vec![0.0; few.rows()];
        let mut reduced = vec![nothing.as_slice(); dense.len()];
        for (place, &column) in known.iter().enumerate() {
            reduced[column] = few.column(place);
        }
        into.fold_rows(&reduced, few.column(known.len()))?;
    }
    Ok(())
}

/// Whose number a column of a refit is.
#[derive(Debug, Clone, Copy)]
enum Owner {
    Amplitude(usize, usize),
    /// Logarithm of a shape over the one of the start.
    LogShape(usize),
}

impl Owner {
    fn number(self, causes: &[Cause]) -> f64 {
        match self {
            Self::Amplitude(cause, amplitude) => causes[cause].amplitudes[amplitude],
            Self::LogShape(_) => 0.0,
        }
    }

    /// Sets it in the causes of the start.
    fn set(self, causes: &mut [Cause], value: f64) {
        match self {
            Self::Amplitude(cause, amplitude) => causes[cause].amplitudes[amplitude] = value,
            Self::LogShape(cause) => causes[cause].shape *= value.exp(),
        }
    }
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

#[cfg(test)]
mod tests {
    use haptical_calibration::{LossChoice, Weights};
    use haptical_identification::{Interrupt, Loss};
    use haptical_model::{Device, Recording};

    use super::*;
    use crate::engine::{Base, square};

    /// Three drives with encoders on their joints, at 1000 rows a second; one joint stands for a while.
    fn drives() -> (Device, Recording) {
        let joint = "[[joint]]\ntransmission = \"capstan\"\ntransmission_ratio = 8.0\ndrum_distance_m = 0.0675\n\
                     external_encoder_sd_rad = 1e-4\n";
        let text = "[[link]]\na_m = 0.2\nalpha_rad = 0.5\nd_m = 0.1\n".repeat(4) + &joint.repeat(3);
        let device = Device::from_toml(&text, "drives.toml").unwrap().device;
        let time_s: Vec<f64> = (0..4000).map(|row| 1e-3 * f64::from(row)).collect();
        let angle = |joint: f64| {
            let moving_s = if joint == 0.0 { 3.0 } else { f64::INFINITY };
            let moving = time_s
                .iter()
                .map(|time_s| 1.7 * (1.0 + joint) * time_s.min(moving_s));
            moving.map(f64::sin).collect::<Vec<f64>>()
        };
        let joint = [0.0, 1.0, 2.0].map(angle);
        let read = |angles: &Vec<f64>| {
            let rows = angles.iter().enumerate();
            let noise = |row: usize| 1e-4 * (1e3 * (row * row) as f64).sin();
            Some(
                rows.map(|(row, angle)| 1.02 * angle + 3e-3 + noise(row))
                    .collect(),
            )
        };
        let recording = Recording {
            line: (2..).take(time_s.len()).collect(),
            output: joint.iter().map(read).collect(),
            joint: joint.to_vec(),
            torque_nm: vec![None; 3],
            time_s: Some(time_s),
            ..Recording::default()
        };
        (device, recording)
    }

    /// Squared residuals and half their gradient.
    fn reduced(problem: &Whitened<'_>, at: &[f64]) -> (f64, Vec<f64>) {
        let all: Vec<usize> = (0..at.len()).collect();
        let mut triangle = Triangle::new(at.len());
        problem.reduce_into(at, &all, &mut triangle).unwrap();
        let gradient = |column: usize| {
            let entries = triangle.column(column).iter();
            entries.zip(triangle.projected()).map(|(a, b)| a * b).sum()
        };
        (
            triangle.cost(),
            all.iter().map(|&column| gradient(column)).collect(),
        )
    }

    /// Norm of the derivatives by one number.
    fn norm(problem: &Whitened<'_>, at: &[f64], column: usize) -> f64 {
        let mut triangle = Triangle::new(1);
        problem.reduce_into(at, &[column], &mut triangle).unwrap();
        triangle.entry(0, 0).abs()
    }

    #[test]
    fn samples_of_the_rows_stand_for_all_of_them() {
        let (device, recording) = drives();
        let loss = LossChoice::Fixed(Loss::Squares);
        let base = Base::fit(&device, &recording, loss, &Interrupt::default()).unwrap();
        let engine = Prepared::new(&base, &recording, &recording)
            .unwrap()
            .fit(None)
            .unwrap();
        let fitting = Fitting {
            data: &engine,
            effects: &[],
            part: &engine.whole,
            least_fall: None,
        };
        let samples = |every: usize| Samples::new(&engine.whole.blocks, 3, recording.len(), every);
        let (some, all) = (samples(20), samples(1));
        let (readings, _) = engine.problem.select(some.rows.as_ref().unwrap());
        assert!(readings.len() <= recording.len() / 2 && all.rows.is_none());
        let weights = Weights::stated(&base.device, &base.channels);
        let streams = &engine.context.streams;
        let problem = BaseProblem::new(&base, &readings, &readings, streams, &weights).unwrap();
        let model = &engine.start.model;
        let some = Whitened::new(&fitting, model, (&some, &problem)).unwrap();
        let all = Whitened::new(&fitting, model, (&all, &engine.problem)).unwrap();
        let start = some.start();
        assert!(start.len() > 6, "{start:?}");
        let here = square(&engine.whole, &engine.start.residual, &[]);
        for problem in [&some, &all] {
            let found = reduced(problem, &start).0;
            assert!((found - here).abs() < 1e-9 * here, "{found} for {here}");
        }
        let left = |problem: &Whitened<'_>, at: &[f64]| {
            let model = problem.model(at);
            let there = problem.problem.evaluate(&model.values, false).unwrap();
            problem.left(&model, &there.residual)
        };
        let apart = |a: &[f64], b: &[f64]| {
            let pairs = a.iter().zip(b);
            pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        // an input drum turns at 8 times 5 rad/s, and the middle of four rows is half a row off: 41 rad/s times 0.5 ms is 2 %
        let mut moved = start.clone();
        let before = left(&all, &start);
        for (column, value) in start.iter().enumerate() {
            let mut there = start.clone();
            there[column] = value + 4.0 * here.sqrt() / norm(&some, &start, column);
            let (sampled, exact) = (left(&some, &there), left(&all, &there));
            let (error, change) = (apart(&sampled, &exact), apart(&exact, &before));
            assert!(
                change > here.sqrt() && error < 0.03 * change,
                "{column}: {error} of {change}"
            );
            moved[column] += 0.1 * (there[column] - value);
        }
        let (_, gradient) = reduced(&some, &moved);
        let largest = gradient
            .iter()
            .fold(0.0_f64, |most, entry| most.max(entry.abs()));
        for (column, analytic) in gradient.iter().enumerate() {
            let at = |step: f64| {
                let mut there = moved.clone();
                there[column] += step;
                reduced(&some, &there).0
            };
            let numeric = (at(1e-7) - at(-1e-7)) / 4e-7;
            assert!(
                (numeric - analytic).abs() < 1e-4 * largest,
                "{column}: {analytic} for {numeric}"
            );
        }
    }
}
