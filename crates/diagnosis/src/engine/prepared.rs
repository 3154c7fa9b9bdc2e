//! A recording with the base model's residuals, before anything is fitted to it.

use haptical_calibration::{Channel, Weights};
use haptical_effects::{Context, Effect, Stream, streams};
use haptical_linalg::SparseColumns;
use haptical_model::Recording;

use super::base::problem::Evaluated;
use super::{Engine, dot, with_causes};
use crate::engine::{Base, BaseProblem, Blocks, Derivatives, Model, Part, Refit};
use crate::noise::{KnownNoise, Noise};
use crate::thresholds::engine::UNSEEN_NOISES;
use crate::{DiagnosisError, Result, noise};

/// A recording with the base model's residuals and derivatives, before anything is fitted to it.
#[derive(Debug)]
pub(crate) struct Prepared<'a> {
    pub(crate) context: Context<'a>,
    pub(crate) problem: BaseProblem<'a>,
    pub(crate) base: &'a Base,
    /// The sensors' own stated deviations, per stream.
    pub(super) own: Vec<f64>,
    /// Rows with a usable reading, per stream.
    pub(crate) usable: Vec<Vec<bool>>,
    /// Derivatives of all parameters at every row.
    pub(super) derivatives: Option<Derivatives>,
    pub(super) residual: Vec<Vec<f64>>,
}

/// A fit of the base model, with the noise and the rows that it was made with.
pub(super) struct BaseFit {
    pub(super) known: KnownNoise,
    pub(super) whole: Part,
    pub(super) fit: Refit,
}

impl<'a> Prepared<'a> {
    /// Evaluates the base model on a recording, and everything's derivatives at `postures`, which are its own or near
    /// them.
    pub(crate) fn new(
        base: &'a Base,
        recording: &'a Recording,
        postures: &'a Recording,
    ) -> Result<Self> {
        let streams = streams(&base.device, &base.channels);
        let (context, evaluated) = rayon::join(
            || Context::new(&base.device, postures, &streams),
            || Self::evaluated(base, (recording, postures), true),
        );
        let (problem, first) = evaluated?;
        Ok(Self::of(base, context?, problem, first))
    }

    /// The same without derivatives of the base model, where what effects add is worked out at it already.
    pub(crate) fn of_context(
        base: &'a Base,
        recording: &'a Recording,
        postures: &'a Recording,
        context: Context<'a>,
    ) -> Result<Self> {
        let (problem, first) = Self::evaluated(base, (recording, postures), false)?;
        Ok(Self::of(base, context, problem, first))
    }

    fn evaluated(
        base: &'a Base,
        (recording, postures): (&'a Recording, &'a Recording),
        has_derivatives: bool,
    ) -> Result<(BaseProblem<'a>, Evaluated)> {
        let weights = Weights::stated(&base.device, &base.channels);
        let streams = streams(&base.device, &base.channels);
        let problem = BaseProblem::new(base, recording, postures, &streams, &weights)?;
        let first = problem.evaluate(&problem.start(), has_derivatives)?;
        Ok((problem, first))
    }

    fn of(
        base: &'a Base,
        mut context: Context<'a>,
        problem: BaseProblem<'a>,
        first: Evaluated,
    ) -> Self {
        let weights = Weights::stated(&base.device, &base.channels);
        let stated = |stream: &Stream| weights.channel_sd.get(&stream.channel).copied();
        let own = context.streams.iter();
        let own = own.map(|stream| stated(stream).unwrap_or(1e-4)).collect();
        let usable = |rows: &Vec<f64>| rows.iter().map(|value| value.is_finite()).collect();
        context.lines = noise::lines(&context, &first.residual);
        Self {
            context,
            problem,
            base,
            own,
            usable: first.residual.iter().map(usable).collect(),
            derivatives: first.derivatives,
            residual: first.residual,
        }
    }

    /// Sums over a channel's readings of their squared residuals and of their stated variances, and their number.
    pub(crate) fn squares(&self, channel: Channel) -> Option<(f64, f64, f64)> {
        let (mut squares, mut stated, mut count) = (0.0, 0.0, 0.0);
        for index in self.context.streams_of(channel) {
            let pairs = self.residual[index].iter().zip(&self.problem.sd[index]);
            let pairs = pairs.zip(&self.usable[index]);
            for ((residual, sd), _) in pairs.filter(|(_, usable)| **usable) {
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
        let known = KnownNoise {
            noise: noise.to_vec(),
            scale: vec![None; noise.len()],
        };
        let blocks = Blocks::new(&self.context, &self.usable, &self.own, &known);
        let all: Vec<usize> = (0..self.base.parameters.len()).collect();
        let columns = self.derivatives.as_ref();
        let columns = columns.map(|own| self.columns(&blocks, own, &all));
        let nothing = || SparseColumns::new(blocks.count(), Vec::new());
        let columns = columns.unwrap_or_else(nothing);
        (blocks, columns)
    }

    /// Derivatives of `chosen` parameters on blocks.
    fn columns(
        &self,
        blocks: &Blocks,
        derivatives: &Derivatives,
        chosen: &[usize],
    ) -> SparseColumns {
        self.problem
            .columns(derivatives, chosen, blocks, &|stream, derivative| {
                blocks.compress(stream, derivative)
            })
    }

    /// Rows that a fit sees, with the base model's derivatives on them.
    pub(super) fn part_of(
        &self,
        blocks: Blocks,
        derivatives: Option<&Derivatives>,
    ) -> Result<Part> {
        let free = &self.base.free;
        let columns = derivatives.filter(|_| !free.is_empty());
        let columns = columns.map(|own| self.columns(&blocks, own, free));
        Part::new(blocks, columns, self.base.stiffness())
    }

    /// Readings that stand alone.
    pub(crate) fn outlying(&self) -> Vec<(Channel, usize)> {
        self.outlying_in(&self.residual)
    }

    /// Readings that stand alone once causes are in the model.
    pub(crate) fn outlying_beside(
        &self,
        effects: &[Box<dyn Effect>],
        model: &Model,
    ) -> Result<Vec<(Channel, usize)>> {
        let residual = self.problem.evaluate(&model.values, false)?.residual;
        let residual = with_causes(residual, &self.context, effects, &model.causes);
        Ok(self.outlying_in(&residual))
    }

    /// The same after some readings were taken out, `cleaned` its postures without them.
    pub(crate) fn without(mut self, gone: &[(Channel, usize)], cleaned: &'a Recording) -> Self {
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
    pub(crate) fn fit(mut self, known: Option<&KnownNoise>) -> Result<Engine<'a>> {
        let residual = std::mem::take(&mut self.residual);
        let start = (self.problem.start(), residual);
        self.fit_from(start, known)
    }

    /// The same from a minimum of another fit. A cause bends the base model along a valley: from where it belongs the way back to
    /// what it is without the cause takes tens of steps.
    pub(crate) fn fit_from_minimum(
        self,
        values: &[f64],
        known: Option<&KnownNoise>,
    ) -> Result<Engine<'a>> {
        let residual = self.problem.evaluate(values, false)?.residual;
        self.fit_from((values.to_vec(), residual), known)
    }

    fn fit_from(
        self,
        start: (Vec<f64>, Vec<Vec<f64>>),
        known: Option<&KnownNoise>,
    ) -> Result<Engine<'a>> {
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
        let BaseFit { known, whole, fit } = self.base_fit(start, known)?;
        let held: Vec<usize> = (0..self.base.parameters.len())
            .filter(|parameter| !self.base.free.contains(parameter))
            .collect();
        let other = self.derivatives.as_ref();
        let other = other.map(|all| self.shown(&self.columns(&whole.blocks, all, &held), &held));
        Ok(Engine {
            floor: self.floors(&known.noise),
            system: whole.system(&self.context, other.as_ref(), &fit.residual)?,
            noise: known.noise,
            scale: known.scale,
            whole,
            start: fit,
            near: None,
            data: self,
        })
    }

    /// The columns of those parameters of which a plausible deviation shows in some reading: others' are rounding, and their directions
    /// chance.
    fn shown(&self, columns: &SparseColumns, parameters: &[usize]) -> SparseColumns {
        let shows = |&(column, parameter): &(usize, &usize)| {
            let entries = columns.column(column).values();
            let size = self.base.parameters[*parameter].plausible_size(&self.base.device);
            dot(entries, entries).sqrt() * size > UNSEEN_NOISES
        };
        let shown = parameters.iter().enumerate().filter(shows);
        let shown = shown.map(|(column, _)| columns.column(column).clone());
        SparseColumns::new(columns.rows(), shown.collect())
    }
}
