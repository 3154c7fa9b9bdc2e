//! The least-squares problem of a device and a recording: weighted residuals and derivatives.

use std::collections::BTreeMap;
use std::ops::Range;

use haptical_identification::{IdentificationError, Matrix, Problem, SparseProblem, Triplet};
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::kinematics::{Twist, distance_m};
use haptical_model::{Device, Evaluation, ModelError, ParameterId, Recording};
use rayon::prelude::*;

use crate::distances::Distances;
use crate::error_rows::outputs_in_bulk;
use crate::outputs::Outputs;
use crate::rotation::{inverse_left_jacobian, measured_rotation, rotation_vector};
use crate::sink::{Place, Sink};
use crate::{CalibrationError, Channel, Weights};

/// Residuals (model minus measurement, over standard deviation) of chosen channels as functions of
/// chosen parameters.
#[derive(Debug)]
pub struct DeviceProblem<'a> {
    device: &'a Device,
    recording: &'a Recording,
    parameters: &'a [ParameterId],
    blocks: Vec<Block>,
    residual_count: usize,
    sees_chain: bool,
    /// Output angles, row by row, where no transmission parameter can change them: a fit of the chain
    /// alone then evaluates each transmission once, not at every step.
    outputs: Option<Vec<f64>>,
}

/// The residuals of one channel: consecutive, in row order.
#[derive(Debug)]
struct Block {
    channel: Channel,
    /// Rows with a reading.
    rows: Vec<usize>,
    /// One over the standard deviation, per entry of `rows`.
    weights: Vec<f64>,
    first: usize,
}

impl Block {
    /// Residual after the last.
    fn end(&self) -> usize {
        self.first + self.rows.len() * self.channel.width()
    }

    /// Where the residuals of a part's rows stand, from `start` on.
    fn within(&self, start: usize) -> Range<usize> {
        let place = |row: usize| {
            let before = self.rows.partition_point(|&other| other < row);
            self.first + before * self.channel.width()
        };
        place(start)..place(start + ROWS_AT_ONCE)
    }
}

/// Rows that one thread works out at a time.
const ROWS_AT_ONCE: usize = 512;

impl<'a> DeviceProblem<'a> {
    /// A problem over `parameters` of `device`; its parameter vector holds their absolute values.
    ///
    /// # Errors
    /// [`CalibrationError::Row`] where the device has no value at a row.
    pub fn new(
        device: &'a Device,
        recording: &'a Recording,
        channels: &[Channel],
        parameters: &'a [ParameterId],
        weights: &Weights,
    ) -> Result<Self, CalibrationError> {
        let mut blocks = Vec::new();
        for &channel in channels {
            let deviations = weights.residual_sd(device, recording, channel)?;
            add_block(&mut blocks, recording, channel, |row| 1.0 / deviations[row]);
        }
        let sees_chain = channels.iter().any(|channel| channel.sees_chain());
        let outputs = fixed_outputs(device, recording, parameters, sees_chain)?;
        Ok(Self {
            device,
            recording,
            parameters,
            residual_count: blocks.last().map_or(0, Block::end),
            blocks,
            sees_chain,
            outputs,
        })
    }

    /// The same for one channel whose readings all weigh the same, for the forms in lanes, without a look
    /// at every row by itself. None where it is another case, or where a number is refused: then
    /// [`DeviceProblem::new`] says which.
    pub(crate) fn in_bulk(
        device: &'a Device,
        recording: &'a Recording,
        channels: &[Channel],
        parameters: &'a [ParameterId],
        weights: &Weights,
    ) -> Option<Self> {
        let &[channel] = channels else {
            return None;
        };
        let weight = 1.0 / weights.common_sd(device, channel)?;
        let mut blocks = Vec::with_capacity(1);
        add_block(&mut blocks, recording, channel, |_| weight);
        let sees_chain = channel.sees_chain();
        let outputs = if sees_chain {
            Some(outputs_in_bulk(device, recording, parameters)?)
        } else {
            None
        };
        Some(Self {
            device,
            recording,
            parameters,
            residual_count: blocks.last().map_or(0, Block::end),
            blocks,
            sees_chain,
            outputs,
        })
    }

    /// The values that the device itself has.
    pub fn start(&self) -> Vec<f64> {
        self.parameters
            .iter()
            .map(|parameter| parameter.value(self.device))
            .collect()
    }

    /// The same problem in lanes, if it is one of a chain's parameters and one distance.
    pub(crate) fn distances(&self) -> Option<Distances> {
        let [block] = self.blocks.as_slice() else {
            return None;
        };
        Distances::new(
            self.device,
            self.recording,
            self.parameters,
            block.channel,
            self.outputs.as_deref()?,
            (&block.rows, &block.weights),
        )
    }

    /// The same problem in lanes, if it is one of a transmission's parameters and its external encoder.
    pub(crate) fn transmission_outputs(&self) -> Option<Outputs> {
        let [block] = self.blocks.as_slice() else {
            return None;
        };
        Outputs::new(
            self.device,
            self.recording,
            self.parameters,
            block.channel,
            (&block.rows, &block.weights),
        )
    }

    /// The device with a parameter vector in place.
    pub fn device_with(&self, values: &[f64]) -> Device {
        let mut device = self.device.clone();
        for (parameter, value) in self.parameters.iter().zip(values) {
            parameter.set(&mut device, *value);
        }
        device
    }

    pub(crate) fn channels(&self) -> impl Iterator<Item = Channel> {
        self.blocks.iter().map(|block| block.channel)
    }

    pub(crate) fn device(&self) -> &Device {
        self.device
    }

    pub(crate) fn parameters(&self) -> &[ParameterId] {
        self.parameters
    }

    /// Where each channel's residuals stand: channel, first residual, count.
    pub fn layout(&self) -> BTreeMap<Channel, (usize, usize)> {
        self.blocks
            .iter()
            .map(|block| {
                (
                    block.channel,
                    (block.first, block.rows.len() * block.channel.width()),
                )
            })
            .collect()
    }

    pub(crate) fn run(
        &self,
        values: &[f64],
        residuals: &mut [f64],
        mut sink: Sink<'_>,
    ) -> Result<(), IdentificationError> {
        let device = self.device_with(values);
        let rows = self.recording.len();
        if rows > ROWS_AT_ONCE {
            match &mut sink {
                Sink::None => return self.run_in_parallel(&device, residuals, None),
                Sink::Dense(free, matrix) => {
                    return self.run_in_parallel(&device, residuals, Some((free, matrix)));
                }
                Sink::Sparse(..) | Sink::Triangles(_) => {}
            }
        }
        let firsts: Vec<usize> = self.blocks.iter().map(|block| block.first).collect();
        self.run_rows(&device, 0..rows, &firsts, residuals, &mut sink)
    }

    /// All rows, some at a time; each is worked out as it is alone.
    fn run_in_parallel(
        &self,
        device: &Device,
        residuals: &mut [f64],
        mut jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        let free = jacobian.as_ref().map(|(free, _)| *free);
        let starts: Vec<usize> = (0..self.recording.len()).step_by(ROWS_AT_ONCE).collect();
        // per part: every block's residuals, one block after the other, and their derivatives
        let parts: Vec<(Vec<f64>, Option<Matrix>)> = starts
            .par_iter()
            .map(|&start| {
                let mut firsts = Vec::with_capacity(self.blocks.len());
                let mut count = 0;
                for block in &self.blocks {
                    firsts.push(count);
                    count += block.within(start).len();
                }
                let mut part = vec![0.0; count];
                let mut matrix = free.map(|free| Matrix::zeros(count, free.len()));
                let mut sink = match (free, &mut matrix) {
                    (Some(free), Some(matrix)) => Sink::Dense(free, matrix),
                    _ => Sink::None,
                };
                let end = (start + ROWS_AT_ONCE).min(self.recording.len());
                self.run_rows(device, start..end, &firsts, &mut part, &mut sink)?;
                Ok((part, matrix))
            })
            .collect::<Result<_, IdentificationError>>()?;
        for (start, (part, derivatives)) in starts.into_iter().zip(&parts) {
            let mut first = 0;
            for block in &self.blocks {
                let whole = block.within(start);
                let own = first..first + whole.len();
                first = own.end;
                residuals[whole.clone()].copy_from_slice(&part[own.clone()]);
                if let (Some((_, matrix)), Some(derivatives)) = (&mut jacobian, derivatives) {
                    for column in 0..derivatives.columns() {
                        matrix.column_mut(column)[whole.clone()]
                            .copy_from_slice(&derivatives.column(column)[own.clone()]);
                    }
                }
            }
        }
        Ok(())
    }

    /// Rows of the recording, each block's residuals written from its entry of `firsts` on.
    fn run_rows(
        &self,
        device: &Device,
        rows: Range<usize>,
        firsts: &[usize],
        residuals: &mut [f64],
        sink: &mut Sink<'_>,
    ) -> Result<(), IdentificationError> {
        let mut evaluation = Evaluation::new(device);
        let mut readings = vec![0.0; device.joints.len()];
        let begins: Vec<usize> = self
            .blocks
            .iter()
            .map(|block| block.rows.partition_point(|&row| row < rows.start))
            .collect();
        let mut cursors = begins.clone();
        for row in rows {
            for (reading, column) in readings.iter_mut().zip(&self.recording.joint) {
                *reading = column[row];
            }
            if self.sees_chain {
                match &self.outputs {
                    Some(outputs) => {
                        let first = row * readings.len();
                        evaluation.move_outputs(&outputs[first..first + readings.len()])
                    }
                    None if matches!(sink, Sink::None) => evaluation.move_pose_to(&readings),
                    None => evaluation.move_to(&readings),
                }
                .map_err(|error| self.at_row(row, &error))?;
            }
            for (position, (block, cursor)) in self.blocks.iter().zip(&mut cursors).enumerate() {
                if block.rows.get(*cursor) != Some(&row) {
                    continue;
                }
                if let Channel::Output { joint } = block.channel
                    && !self.sees_chain
                {
                    evaluation
                        .move_joint(joint, readings[joint])
                        .map_err(|error| self.at_row(row, &error))?;
                }
                let place = Place {
                    block: position,
                    channel: block.channel,
                    index: firsts[position] + (*cursor - begins[position]) * block.channel.width(),
                    weight: block.weights[*cursor],
                    row,
                };
                self.residual(&place, device, &evaluation, residuals, sink)
                    .map_err(|error| self.at_row(row, &error))?;
                *cursor += 1;
            }
        }
        Ok(())
    }

    fn residual(
        &self,
        place: &Place,
        device: &Device,
        evaluation: &Evaluation<'_>,
        residuals: &mut [f64],
        sink: &mut Sink<'_>,
    ) -> Result<(), ModelError> {
        let (index, weight, row) = (place.index, place.weight, place.row);
        match place.channel {
            Channel::Output { joint } => {
                let measured = column(&self.recording.output[joint], row);
                residuals[index] = weight * (evaluation.output_rad(joint) - measured);
                sink.put(self.parameters, place, residuals, |parameter| {
                    Ok([
                        weight * evaluation.output_derivative(joint, parameter),
                        0.0,
                        0.0,
                    ])
                })
            }
            Channel::Cable { index: cable } => {
                let anchor =
                    Vector3::from(device.cables.get(cable).map_or([0.0; 3], |c| c.anchor_m));
                let pose = evaluation.pose()?;
                let distance = distance_m(&pose.position_m, &anchor)?;
                let measured = column(&self.recording.cable_m[cable], row);
                residuals[index] = weight * (distance - measured);
                // docs/equations.md, "Distance derivative": the direction once for all parameters.
                let direction = (pose.position_m - anchor) * (weight / distance);
                sink.put(self.parameters, place, residuals, |parameter| {
                    let along = direction.dot(&evaluation.pose_derivative(parameter).linear);
                    Ok([along, 0.0, 0.0])
                })
            }
            Channel::Position => {
                let pose = evaluation.pose()?;
                if let Some(axes) = &self.recording.position_m {
                    for axis in 0..3 {
                        residuals[index + axis] =
                            weight * (pose.position_m[axis] - axes[axis][row]);
                    }
                }
                sink.put(self.parameters, place, residuals, |parameter| {
                    Ok((evaluation.pose_derivative(parameter).linear * weight).into())
                })
            }
            Channel::Orientation => {
                let measured = measured_rotation(self.recording, row);
                let rest = rotation_vector(&(evaluation.pose()?.rotation * measured.transpose()));
                for axis in 0..3 {
                    residuals[index + axis] = weight * rest[axis];
                }
                let inverse = inverse_left_jacobian(&rest);
                sink.put(self.parameters, place, residuals, |parameter| {
                    let Twist { angular, .. } = evaluation.pose_derivative(parameter);
                    Ok((inverse * angular * weight).into())
                })
            }
        }
    }

    fn at_row(&self, row: usize, error: &ModelError) -> IdentificationError {
        IdentificationError::Evaluation {
            reason: format!("line {} of the log: {error}", self.recording.line[row]),
        }
    }
}

impl Problem for DeviceProblem<'_> {
    fn parameter_count(&self) -> usize {
        self.parameters.len()
    }

    fn residual_count(&self) -> usize {
        self.residual_count
    }

    fn evaluate(
        &self,
        parameters: &[f64],
        residuals: &mut [f64],
        jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        let sink = match jacobian {
            None => Sink::None,
            Some((free, matrix)) => Sink::Dense(free, matrix),
        };
        self.run(parameters, residuals, sink)
    }
}

impl SparseProblem for DeviceProblem<'_> {
    fn evaluate_sparse(
        &self,
        parameters: &[f64],
        free: &[usize],
        residuals: &mut [f64],
        entries: &mut Vec<Triplet>,
    ) -> Result<(), IdentificationError> {
        entries.clear();
        self.run(parameters, residuals, Sink::Sparse(free, entries))
    }
}

/// Adds a channel's rows after the blocks that are there.
fn add_block(
    blocks: &mut Vec<Block>,
    recording: &Recording,
    channel: Channel,
    weight: impl Fn(usize) -> f64,
) {
    let rows: Vec<usize> = (0..recording.len())
        .filter(|&row| channel.has_reading(recording, row))
        .collect();
    blocks.push(Block {
        channel,
        weights: rows.iter().map(|&row| weight(row)).collect(),
        rows,
        first: blocks.last().map_or(0, Block::end),
    });
}

/// Every row's output angles, unless a parameter can change them or nothing asks for the chain.
fn fixed_outputs(
    device: &Device,
    recording: &Recording,
    parameters: &[ParameterId],
    sees_chain: bool,
) -> Result<Option<Vec<f64>>, CalibrationError> {
    let is_transmission =
        |parameter: &ParameterId| matches!(parameter, ParameterId::Transmission { .. });
    if !sees_chain || parameters.iter().any(is_transmission) {
        return Ok(None);
    }
    let mut outputs = Vec::with_capacity(recording.len() * device.joints.len());
    for row in 0..recording.len() {
        for (index, (joint, column)) in device.joints.iter().zip(&recording.joint).enumerate() {
            let error = joint
                .error_rad(column[row])
                .map_err(|source| CalibrationError::Row {
                    line: recording.line[row],
                    source: ModelError::Transmission {
                        joint: index + 1,
                        source,
                    },
                })?;
            outputs.push(column[row] + error);
        }
    }
    Ok(Some(outputs))
}

/// A reading; channels are only asked for rows that have one.
fn column(column: &Option<Vec<f64>>, row: usize) -> f64 {
    column.as_ref().map_or(f64::NAN, |column| column[row])
}
