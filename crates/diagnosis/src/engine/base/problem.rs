//! Residuals and derivatives of the base model at every row of a recording.

use std::collections::BTreeMap;

use haptical_calibration::{Channel, DeviceProblem, Weights};
use haptical_effects::Stream;
use haptical_identification::{Matrix, Problem};
use haptical_linalg::{Direction, SparseColumns};
use haptical_model::{Device, Recording};

use crate::Result;
use crate::engine::{Base, Blocks};

/// Residuals (measured minus model) and derivatives of the base model on one recording.
///
/// External encoders depend on their own joints alone: each is worked out by itself, with the few columns that it has.
#[derive(Debug)]
pub(crate) struct BaseProblem<'a> {
    base: &'a Base,
    /// Where residuals and where derivatives are taken.
    recordings: [&'a Recording; 2],
    groups: Vec<Group<'a>>,
    /// Per stream: its group; none without a reading.
    group: Vec<Option<usize>>,
    /// Per stream and row: place among the group's residuals; `usize::MAX` without a reading.
    place: Vec<Vec<usize>>,
    /// Per stream and row: stated standard deviation, quantization included.
    pub(crate) sd: Vec<Vec<f64>>,
}

/// Channels that are worked out together.
#[derive(Debug)]
struct Group<'a> {
    channels: Vec<Channel>,
    problem: DeviceProblem<'a>,
    /// The same at the postures that derivatives are taken at, where these are others.
    slopes: Option<DeviceProblem<'a>>,
    /// Parameters that they depend on, ascending.
    seen: Vec<usize>,
}

/// Derivatives of a group's residuals over their standard deviations, by the parameters that it depends on.
#[derive(Debug)]
pub(crate) struct Derivatives(Vec<(Vec<usize>, Matrix)>);

impl Group<'_> {
    /// Residuals and, where they are asked for, derivatives.
    fn evaluate(&self, values: &[f64], derivatives: bool) -> Result<(Vec<f64>, Option<Matrix>)> {
        let count = self.problem.residual_count();
        let mut residuals = vec![0.0; count];
        if !derivatives {
            self.problem.evaluate(values, &mut residuals, None)?;
            return Ok((residuals, None));
        }
        let mut matrix = Matrix::zeros(count, self.seen.len());
        let at = self.slopes.as_ref().unwrap_or(&self.problem);
        at.evaluate(values, &mut residuals, Some((&self.seen, &mut matrix)))?;
        if self.slopes.is_some() {
            self.problem.evaluate(values, &mut residuals, None)?;
        }
        Ok((residuals, Some(matrix)))
    }
}

impl<'a> BaseProblem<'a> {
    /// Residuals of `recording`, derivatives at `postures`: the same rows, at the same readings or near them.
    pub(crate) fn new(
        base: &'a Base,
        recording: &'a Recording,
        postures: &'a Recording,
        streams: &[Stream],
        weights: &Weights,
    ) -> Result<Self> {
        let (device, parameters) = (&base.device, &base.parameters);
        // touches in metres, as the effects' columns are
        let problem = |recording: &'a Recording| {
            DeviceProblem::new(device, recording, &base.channels, parameters, weights)
        };
        let mut slopes = match std::ptr::eq(recording, postures) {
            true => Vec::new(),
            false => problem(postures)?.apart(),
        }
        .into_iter();
        let groups = problem(recording)?.apart().into_iter();
        let groups = groups.map(|(channels, problem)| Group {
            channels,
            slopes: slopes.next().map(|(_, slopes)| slopes),
            seen: problem.seen(),
            problem,
        });
        let groups: Vec<Group<'a>> = groups.collect();
        let mut deviations = BTreeMap::new();
        for &channel in &base.channels {
            deviations.insert(channel, weights.residual_sd(device, recording, channel)?);
        }
        let layouts: Vec<_> = groups.iter().map(|group| group.problem.layout()).collect();
        let (mut group, mut place, mut sd) = (Vec::new(), Vec::new(), Vec::new());
        for stream in streams {
            let mut places = vec![usize::MAX; recording.len()];
            let width = stream.channel.width();
            let own = (groups.iter()).position(|group| group.channels.contains(&stream.channel));
            let first = own.and_then(|own| layouts[own].get(&stream.channel));
            if let Some(&(first, _)) = first {
                let with_reading =
                    (0..recording.len()).filter(|&row| stream.channel.has_reading(recording, row));
                for (index, row) in with_reading.enumerate() {
                    places[row] = first + index * width + stream.axis;
                }
            }
            group.push(own);
            place.push(places);
            sd.push(deviations.get(&stream.channel).cloned().unwrap_or_default());
        }
        Ok(Self {
            base,
            recordings: [recording, postures],
            groups,
            group,
            place,
            sd,
        })
    }

    /// Some rows of its recordings; those of the second are the first's where they are of one recording.
    pub(crate) fn select(&self, rows: &[usize]) -> (Recording, Option<Recording>) {
        let [readings, postures] = self.recordings;
        let is_one = std::ptr::eq(readings, postures);
        let postures = (!is_one).then(|| postures.select(rows));
        (readings.select(rows), postures)
    }

    pub(crate) fn start(&self) -> Vec<f64> {
        let parameters = self.base.parameters.iter();
        parameters
            .map(|parameter| parameter.value(&self.base.device))
            .collect()
    }

    pub(crate) fn device_with(&self, values: &[f64]) -> Device {
        let mut device = self.base.device.clone();
        for (parameter, value) in self.base.parameters.iter().zip(values) {
            parameter.set(&mut device, *value);
        }
        device
    }

    /// Measured minus model per stream and row, in the stream's unit; NaN without a reading. With
    /// `derivatives`, those of all parameters too.
    pub(crate) fn evaluate(&self, values: &[f64], derivatives: bool) -> Result<Evaluated> {
        self.base.interrupt.check()?;
        let derivatives = derivatives && !self.base.parameters.is_empty();
        let made: Vec<Result<_>> =
            haptical_parallel::map(&self.groups, |group| group.evaluate(values, derivatives));
        let mut residuals = Vec::with_capacity(made.len());
        let mut matrices = Vec::with_capacity(made.len());
        for (group, made) in self.groups.iter().zip(made) {
            let (own, matrix) = made?;
            residuals.push(own);
            matrices.extend(matrix.map(|matrix| (group.seen.clone(), matrix)));
        }
        let streams = self.group.iter().zip(&self.place).zip(&self.sd);
        let residual = streams.map(|((group, places), sd)| {
            let own: &[f64] = group.map_or(&[], |group| &residuals[group]);
            let rows = places.iter().zip(sd);
            let of_row = |(&place, sd): (&usize, &f64)| match own.get(place) {
                Some(scaled) => -scaled * sd,
                None => f64::NAN,
            };
            rows.map(of_row).collect()
        });
        Ok(Evaluated {
            residual: residual.collect(),
            derivatives: derivatives.then_some(Derivatives(matrices)),
        })
    }

    /// Takes a reading out.
    pub(crate) fn forget(&mut self, stream: usize, row: usize) {
        if let Some(place) = self.place[stream].get_mut(row) {
            *place = usize::MAX;
        }
    }

    /// One parameter's derivative on one stream, by row, in the stream's unit, 0 without a reading; none where the stream
    /// does not depend on it.
    pub(crate) fn derivative<'m>(
        &'m self,
        derivatives: &'m Derivatives,
        stream: usize,
        parameter: usize,
    ) -> Option<impl Fn(usize) -> f64 + 'm> {
        let (seen, matrix) = derivatives.0.get(self.group[stream]?)?;
        let column = matrix.column(seen.binary_search(&parameter).ok()?);
        let (place, sd) = (&self.place[stream], &self.sd[stream]);
        Some(move |row: usize| column.get(place[row]).map_or(0.0, |entry| entry * sd[row]))
    }
}

impl BaseProblem<'_> {
    /// Derivatives of `chosen` parameters on blocks, to which `compress` brings those of a stream's rows.
    pub(crate) fn columns(
        &self,
        derivatives: &Derivatives,
        chosen: &[usize],
        blocks: &Blocks,
        compress: &Compress<'_>,
    ) -> SparseColumns {
        let of_parameter = |&parameter: &usize| {
            // from the first stream that depends on it to the last
            let mut first = 0;
            let mut column: Vec<f64> = Vec::new();
            for stream in 0..self.group.len() {
                let range = blocks.range(stream);
                if let Some(derivative) = self.derivative(derivatives, stream, parameter) {
                    if column.is_empty() {
                        first = range.start;
                    }
                    column.resize(range.start - first, 0.0);
                    column.extend(compress(stream, &derivative));
                }
            }
            Direction::from_part(first, column)
        };
        let columns: Vec<Direction> = haptical_parallel::map(chosen, of_parameter);
        SparseColumns::new(blocks.count(), columns)
    }
}

/// Whitened blocks of a stream's rows.
type Compress<'c> = dyn Fn(usize, &dyn Fn(usize) -> f64) -> Vec<f64> + Sync + 'c;

/// Outcome of [`BaseProblem::evaluate`].
#[derive(Debug)]
pub(crate) struct Evaluated {
    pub(crate) residual: Vec<Vec<f64>>,
    pub(crate) derivatives: Option<Derivatives>,
}
