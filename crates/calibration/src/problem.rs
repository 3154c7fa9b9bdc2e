//! The least-squares problem of a device and a recording: weighted residuals and derivatives.

use std::collections::BTreeMap;

use haptical_identification::{IdentificationError, Matrix, Problem, SparseProblem, Triplet};
use haptical_model::kinematics::nalgebra::{
    Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3,
};
use haptical_model::kinematics::{Twist, distance_derivative, distance_m};
use haptical_model::{Device, Evaluation, ModelError, ParameterId, Recording};

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

/// Where the derivatives go.
enum Sink<'s> {
    None,
    Dense(&'s [usize], &'s mut Matrix),
    Sparse(&'s [usize], &'s mut Vec<Triplet>),
}

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
        let mut first = 0;
        for &channel in channels {
            let deviations = weights.residual_sd(device, recording, channel)?;
            let rows: Vec<usize> = (0..recording.len())
                .filter(|&row| channel.has_reading(recording, row))
                .collect();
            let inverse = rows.iter().map(|&row| 1.0 / deviations[row]).collect();
            let size = rows.len() * channel.width();
            blocks.push(Block {
                channel,
                rows,
                weights: inverse,
                first,
            });
            first += size;
        }
        let sees_chain = channels.iter().any(|channel| channel.sees_chain());
        Ok(Self {
            device,
            recording,
            parameters,
            blocks,
            residual_count: first,
            sees_chain,
        })
    }

    /// The values that the device itself has.
    pub fn start(&self) -> Vec<f64> {
        self.parameters
            .iter()
            .map(|parameter| parameter.value(self.device))
            .collect()
    }

    /// The device with a parameter vector in place.
    pub fn device_with(&self, values: &[f64]) -> Device {
        let mut device = self.device.clone();
        for (parameter, value) in self.parameters.iter().zip(values) {
            parameter.set(&mut device, *value);
        }
        device
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

    fn run(
        &self,
        values: &[f64],
        residuals: &mut [f64],
        mut sink: Sink<'_>,
    ) -> Result<(), IdentificationError> {
        let device = self.device_with(values);
        let mut evaluation = Evaluation::new(&device);
        let mut readings = vec![0.0; device.joints.len()];
        let mut cursors = vec![0_usize; self.blocks.len()];
        for row in 0..self.recording.len() {
            for (reading, column) in readings.iter_mut().zip(&self.recording.joint) {
                *reading = column[row];
            }
            if self.sees_chain {
                evaluation
                    .move_to(&readings)
                    .map_err(|error| self.at_row(row, &error))?;
            }
            for (block, cursor) in self.blocks.iter().zip(&mut cursors) {
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
                    index: block.first + *cursor * block.channel.width(),
                    weight: block.weights[*cursor],
                    row,
                };
                self.residual(
                    block.channel,
                    &place,
                    &device,
                    &evaluation,
                    residuals,
                    &mut sink,
                )
                .map_err(|error| self.at_row(row, &error))?;
                *cursor += 1;
            }
        }
        Ok(())
    }

    fn residual(
        &self,
        channel: Channel,
        place: &Place,
        device: &Device,
        evaluation: &Evaluation<'_>,
        residuals: &mut [f64],
        sink: &mut Sink<'_>,
    ) -> Result<(), ModelError> {
        let (index, weight, row) = (place.index, place.weight, place.row);
        match channel {
            Channel::Output { joint } => {
                let measured = column(&self.recording.output[joint], row);
                residuals[index] = weight * (evaluation.output_rad(joint) - measured);
                sink.put(self.parameters, channel, index, |parameter| {
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
                sink.put(self.parameters, channel, index, |parameter| {
                    let twist = evaluation.pose_derivative(parameter);
                    Ok([
                        weight * distance_derivative(pose, &anchor, &twist)?,
                        0.0,
                        0.0,
                    ])
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
                sink.put(self.parameters, channel, index, |parameter| {
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
                sink.put(self.parameters, channel, index, |parameter| {
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

struct Place {
    index: usize,
    weight: f64,
    row: usize,
}

impl Sink<'_> {
    /// Writes the derivatives of one channel's residuals at one row.
    fn put(
        &mut self,
        parameters: &[ParameterId],
        channel: Channel,
        index: usize,
        mut derivative: impl FnMut(ParameterId) -> Result<[f64; 3], ModelError>,
    ) -> Result<(), ModelError> {
        let width = channel.width();
        match self {
            Sink::None => {}
            Sink::Dense(free, matrix) => {
                for (position, &parameter) in free.iter().enumerate() {
                    let values = if can_see(channel, parameters[parameter]) {
                        derivative(parameters[parameter])?
                    } else {
                        [0.0; 3]
                    };
                    matrix.column_mut(position)[index..index + width]
                        .copy_from_slice(&values[..width]);
                }
            }
            Sink::Sparse(free, entries) => {
                for (position, &parameter) in free.iter().enumerate() {
                    if can_see(channel, parameters[parameter]) {
                        let values = derivative(parameters[parameter])?;
                        for (axis, &value) in values[..width].iter().enumerate() {
                            entries.push(Triplet {
                                row: index + axis,
                                column: position,
                                value,
                            });
                        }
                    }
                }
            }
        }
        Ok(())
    }
}

/// Whether a channel can depend on a parameter at all: an external encoder sees its own
/// transmission, everything else sees the whole chain.
fn can_see(channel: Channel, parameter: ParameterId) -> bool {
    match (channel, parameter) {
        (Channel::Output { joint: output }, ParameterId::Transmission { joint, .. }) => {
            output == joint
        }
        (Channel::Output { .. }, ParameterId::Link { .. }) => false,
        _ => true,
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

/// A reading; channels are only asked for rows that have one.
fn column(column: &Option<Vec<f64>>, row: usize) -> f64 {
    column.as_ref().map_or(f64::NAN, |column| column[row])
}

/// The tracker's orientation at a row, as a rotation matrix.
pub(crate) fn measured_rotation(recording: &Recording, row: usize) -> Matrix3<f64> {
    match &recording.orientation_wxyz {
        Some([w, x, y, z]) => {
            let quaternion = Quaternion::new(w[row], x[row], y[row], z[row]);
            UnitQuaternion::from_quaternion(quaternion)
                .to_rotation_matrix()
                .into_inner()
        }
        None => Matrix3::from_element(f64::NAN),
    }
}

/// Rotation vector of a rotation matrix.
pub(crate) fn rotation_vector(rotation: &Matrix3<f64>) -> Vector3<f64> {
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*rotation)).scaled_axis()
}

/// Inverse of the left Jacobian of SO(3): d log(exp([w]) R) / d w at w = 0, for log R = v
/// (Chirikjian 2012, section 10.6): 1 - [v]/2 + (1/|v|^2 - cot(|v|/2)/(2|v|)) [v]^2.
fn inverse_left_jacobian(v: &Vector3<f64>) -> Matrix3<f64> {
    let angle = v.norm();
    let cross = v.cross_matrix();
    let factor = if angle < 1e-4 {
        // Series: the closed form loses all digits near zero.
        1.0 / 12.0 + angle * angle / 720.0
    } else {
        1.0 / (angle * angle) - 0.5 / (angle * (0.5 * angle).tan())
    };
    Matrix3::identity() - cross * 0.5 + cross * cross * factor
}
