//! Standard deviation of every residual: the channel's own and the motor encoders' quantization.

use std::collections::BTreeMap;

use haptical_model::{Device, Evaluation, Joint, Recording};

use crate::{CalibrationError, Channel};

/// Stated noise where neither the device file nor the recording gives one: one tenth of a
/// millimetre or milliradian; the residuals' own size then decides the intervals.
const UNSTATED_SD: f64 = 1e-4;

/// Standard deviations of residuals.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Weights {
    /// Standard deviation of each channel's own readings, in its unit.
    pub channel_sd: BTreeMap<Channel, f64>,
    /// Factor on each channel's total standard deviation, from the residuals of an earlier fit.
    pub factor: BTreeMap<Channel, f64>,
}

impl Weights {
    /// The device file's figures.
    pub fn stated(device: &Device, channels: &[Channel]) -> Self {
        let channel_sd = channels
            .iter()
            .map(|&channel| {
                let sd = match channel {
                    Channel::Output { joint } => device.joints[joint].output_sd_rad(),
                    Channel::Cable { index } => device.cable_sd_m(index),
                    Channel::Position => device.tracker.and_then(|t| t.position_sd_m),
                    Channel::Orientation => device.tracker.and_then(|t| t.rotation_sd_rad),
                };
                (channel, sd.unwrap_or(UNSTATED_SD))
            })
            .collect();
        Self {
            channel_sd,
            factor: BTreeMap::new(),
        }
    }

    /// The standard deviation that all residuals of a channel share; none where the step of a reading adds
    /// to it, which differs from row to row.
    pub(crate) fn common_sd(&self, device: &Device, channel: Channel) -> Option<f64> {
        let has_steps = |joint: &Joint| joint.reading_quantum_rad().is_some_and(|step| step != 0.0);
        let is_stepped = match channel {
            Channel::Output { joint } => has_steps(device.joints.get(joint)?),
            _ => device.joints.iter().any(has_steps),
        };
        let (own, factor) = self.own_sd(channel);
        (!is_stepped).then(|| factor * (own * own).sqrt())
    }

    /// A channel's own standard deviation, and the factor on the whole.
    fn own_sd(&self, channel: Channel) -> (f64, f64) {
        let own = self.channel_sd.get(&channel).copied();
        let factor = self.factor.get(&channel).copied();
        (own.unwrap_or(UNSTATED_SD), factor.unwrap_or(1.0))
    }

    /// Standard deviation of a channel's residual at each row of the recording (rows without a
    /// reading included): var = factor^2 (sd^2 + sum_i (d residual / d reading_i)^2 q_i^2 / 12),
    /// q_i the step of joint i's reading (docs/equations.md, "Propagated quantization"). For
    /// positions and orientations the mean over the three axes.
    ///
    /// # Errors
    /// [`CalibrationError::Row`] where the device has no value.
    pub fn residual_sd(
        &self,
        device: &Device,
        recording: &Recording,
        channel: Channel,
    ) -> Result<Vec<f64>, CalibrationError> {
        let (own, factor) = self.own_sd(channel);
        let quantum_variances: Vec<f64> = device
            .joints
            .iter()
            .map(|joint| {
                joint
                    .reading_quantum_rad()
                    .map_or(0.0, |step| step * step / 12.0)
            })
            .collect();
        let mut evaluation = Evaluation::new(device);
        let mut readings = vec![0.0; device.joints.len()];
        let mut deviations = Vec::with_capacity(recording.len());
        for row in 0..recording.len() {
            for (reading, column) in readings.iter_mut().zip(&recording.joint) {
                *reading = column[row];
            }
            let at_row = |source| CalibrationError::Row {
                line: recording.line[row],
                source,
            };
            let propagated = match channel {
                Channel::Output { joint } => {
                    evaluation
                        .move_joint(joint, readings[joint])
                        .map_err(at_row)?;
                    evaluation.output_slope(joint).powi(2) * quantum_variances[joint]
                }
                _ => {
                    evaluation.move_to(&readings).map_err(at_row)?;
                    let mut sum = 0.0;
                    for (joint, variance) in quantum_variances.iter().enumerate() {
                        let twist = evaluation.reading_twist(joint);
                        sum += variance
                            * sensitivity_square(&evaluation, device, channel, &twist)
                                .map_err(at_row)?;
                    }
                    sum
                }
            };
            deviations.push(factor * (own * own + propagated).sqrt());
        }
        Ok(deviations)
    }
}

fn sensitivity_square(
    evaluation: &Evaluation<'_>,
    device: &Device,
    channel: Channel,
    twist: &haptical_model::kinematics::Twist,
) -> Result<f64, haptical_model::ModelError> {
    use haptical_model::kinematics::{distance_derivative, nalgebra::Vector3};
    Ok(match channel {
        Channel::Cable { index } => {
            let anchor = device
                .cables
                .get(index)
                .map_or([0.0; 3], |cable| cable.anchor_m);
            distance_derivative(evaluation.pose()?, &Vector3::from(anchor), twist)?.powi(2)
        }
        Channel::Position => twist.linear.norm_squared() / 3.0,
        Channel::Orientation => twist.angular.norm_squared() / 3.0,
        Channel::Output { .. } => 0.0,
    })
}
