//! One pose of a device, with every derivative that an identification needs, without allocation.

use haptical_kinematics::{LinkDerivatives, Pose, Twist};
use haptical_transmission::LawError;

use crate::device::chain::Chains;
use crate::{Device, DeviceChain, JointType, ModelError, ParameterId};

/// Evaluates a device at joint readings; made once, used for every row of a recording.
///
/// Joints and parameters are those of the device: methods that take one panic with the index where the
/// device does not have it. Before the first [`Evaluation::move_to`] outputs and errors are zero.
#[derive(Debug, Clone)]
pub struct Evaluation<'d> {
    device: &'d Device,
    chains: Chains,
    outputs: Vec<f64>,
    /// Angles of the links: the outputs, less what a joint yields behind its encoder.
    link_angles: Vec<f64>,
    /// Drive torques at this row; empty where nothing yields to them.
    torque_nm: Vec<f64>,
    /// What the rows but row 0 of the hand's chain move by.
    variables: Vec<f64>,
    errors: Vec<JointError>,
    /// Of the rows of the hand's chain.
    link_derivatives: Vec<LinkDerivatives>,
    pose: Option<Pose>,
}

/// Transmission error of one joint at its reading.
#[derive(Debug, Clone, Default)]
struct JointError {
    value: f64,
    slope: f64,
    derivatives: Vec<f64>,
}

impl<'d> Evaluation<'d> {
    /// Prepares the evaluation of a device.
    pub fn new(device: &'d Device) -> Self {
        let errors = device
            .joints
            .iter()
            .map(|joint| JointError {
                derivatives: vec![0.0; joint.error_parameter_count()],
                ..JointError::default()
            })
            .collect();
        Self {
            device,
            chains: Chains::new(device),
            outputs: vec![0.0; device.joints.len()],
            link_angles: vec![0.0; device.joints.len()],
            torque_nm: Vec::new(),
            variables: vec![0.0; device.links.len().saturating_sub(1)],
            errors,
            link_derivatives: vec![LinkDerivatives::default(); device.links.len()],
            pose: None,
        }
    }

    /// Chooses the hand (from 0) of the next moves, as [`Device::hand_at`] says for a row of a log. A device without
    /// hands with names has one, which is chosen.
    pub fn choose_hand(&mut self, hand: Option<usize>) {
        if self.device.has_hands() && hand != self.chains.hand {
            self.chains.hand = hand;
            self.pose = None;
        }
    }

    /// Moves to joint readings (one per joint): transmissions, and the chain if there are links.
    ///
    /// # Errors
    /// [`ModelError`] where a transmission or the chain has no value.
    pub fn move_to(&mut self, readings: &[f64]) -> Result<(), ModelError> {
        self.check_count(readings)?;
        // a pose of earlier readings must not outlive a failure below
        self.pose = None;
        for (index, reading) in readings.iter().enumerate() {
            self.move_joint(index, *reading)?;
        }
        self.move_chain()
    }

    /// Moves the chain to output angles (one per joint) that were worked out before. Transmissions
    /// are not evaluated: what is asked of them afterwards is that of the last reading.
    ///
    /// # Errors
    /// [`ModelError`] where the chain has no value.
    pub fn move_outputs(&mut self, outputs: &[f64]) -> Result<(), ModelError> {
        self.check_count(outputs)?;
        self.outputs.copy_from_slice(outputs);
        self.move_chain()
    }

    /// Takes outputs (one per joint) and the handle's pose that were worked out elsewhere, many at a time: every
    /// derivative stays that of the last [`Evaluation::move_to`].
    ///
    /// # Errors
    /// [`ModelError::JointCount`].
    pub fn place(&mut self, outputs: &[f64], pose: Pose) -> Result<(), ModelError> {
        self.check_count(outputs)?;
        self.outputs.copy_from_slice(outputs);
        self.pose = Some(pose);
        Ok(())
    }

    /// Moves to joint readings as [`Evaluation::move_to`] does, for outputs and pose alone: every
    /// derivative stays that of the last [`Evaluation::move_to`].
    ///
    /// # Errors
    /// [`ModelError`] where a transmission or the chain has no value.
    pub fn move_pose_to(&mut self, readings: &[f64]) -> Result<(), ModelError> {
        self.check_count(readings)?;
        self.pose = None;
        for (index, reading) in readings.iter().enumerate() {
            let error = self.device.joints[index].error_rad(*reading);
            let error = error.map_err(at_joint(index))?;
            self.errors[index].value = error;
            self.outputs[index] = reading + error;
        }
        if self.device.has_links() {
            let count = self.take_variables()?;
            let chain = self.chains.chosen()?.chain()?;
            self.pose = Some(chain.pose(&self.variables[..count])?);
        }
        Ok(())
    }

    /// The drive torques \[N m\] (one per joint, positive along +theta) of the next moves: a compliant
    /// joint's link lags its external encoder by torque times compliance. A torque that is not known is none.
    pub fn set_torques(&mut self, torque_nm: &[f64]) {
        self.torque_nm.clear();
        let known = torque_nm
            .iter()
            .map(|torque| if torque.is_finite() { *torque } else { 0.0 });
        self.torque_nm.extend(known);
        self.torque_nm.resize(self.outputs.len(), 0.0);
    }

    /// Variables of the chosen hand's chain; how many.
    fn take_variables(&mut self) -> Result<usize, ModelError> {
        self.link_angles.copy_from_slice(&self.outputs);
        for (joint, torque) in self.torque_nm.iter().enumerate() {
            self.link_angles[joint] -= torque * self.device.compliance_rad_per_nm(joint);
        }
        let chain = self.chains.chosen()?;
        chain.variables(&self.link_angles, &mut self.variables);
        Ok(chain.drives().len())
    }

    fn check_count(&self, numbers: &[f64]) -> Result<(), ModelError> {
        let (expected, found) = (self.device.joints.len(), numbers.len());
        if found == expected {
            Ok(())
        } else {
            Err(ModelError::JointCount { expected, found })
        }
    }

    fn move_chain(&mut self) -> Result<(), ModelError> {
        // a pose of earlier readings must not outlive a failure below
        self.pose = None;
        if self.device.has_links() {
            let count = self.take_variables()?;
            let chain = self.chains.chosen()?.chain()?;
            let derivatives = &mut self.link_derivatives[..=count];
            self.pose = Some(chain.derivatives(&self.variables[..count], derivatives)?);
        }
        Ok(())
    }

    /// Evaluates one transmission alone (joint from 0).
    ///
    /// # Errors
    /// [`ModelError::Transmission`].
    pub fn move_joint(&mut self, joint: usize, reading: f64) -> Result<(), ModelError> {
        let error = &mut self.errors[joint];
        let (value, slope) = self.device.joints[joint]
            .evaluate_error(reading, &mut error.derivatives)
            .map_err(at_joint(joint))?;
        (error.value, error.slope) = (value, slope);
        self.outputs[joint] = reading + value;
        Ok(())
    }

    /// Joints of the device.
    pub fn joint_count(&self) -> usize {
        self.outputs.len()
    }

    /// Handle pose in frame (-1).
    ///
    /// # Errors
    /// [`ModelError::NoLinks`].
    pub fn pose(&self) -> Result<&Pose, ModelError> {
        self.pose.as_ref().ok_or_else(|| ModelError::NoLinks {
            device: self.device.name.clone(),
        })
    }

    /// Pose of the frame behind row 0, the robot's base, in frame (-1).
    ///
    /// # Errors
    /// [`ModelError::NoLinks`], or as [`haptical_kinematics::Chain::pose`].
    pub fn base_pose(&self) -> Result<Pose, ModelError> {
        self.pose()?;
        Ok(self.chains.chosen()?.part(1)?.pose(&[])?)
    }

    /// What the external encoder of a joint (from 0) should read: reading + error.
    pub fn output_rad(&self, joint: usize) -> f64 {
        self.outputs[joint]
    }

    /// Transmission error of a joint (from 0).
    pub fn error_rad(&self, joint: usize) -> f64 {
        self.errors[joint].value
    }

    /// d output / d reading of a joint (from 0).
    pub fn output_slope(&self, joint: usize) -> f64 {
        1.0 + self.errors[joint].slope
    }

    /// d output / d parameter for a transmission parameter of that joint, else 0.
    pub fn output_derivative(&self, output_joint: usize, parameter: ParameterId) -> f64 {
        match parameter {
            ParameterId::Transmission { joint, index } if joint == output_joint => {
                self.errors[joint].derivatives[index]
            }
            _ => 0.0,
        }
    }

    /// Derivative of the handle's pose with respect to any parameter, as a twist in frame (-1). The tracker,
    /// cables and what is touched do not move the handle; what effects do is not part of this evaluation.
    pub fn pose_derivative(&self, parameter: ParameterId) -> Twist {
        match parameter {
            ParameterId::Compliance { joint } => {
                let torque = self.torque_nm.get(joint).copied().unwrap_or(0.0);
                scaled(self.joint_twist(joint), -torque)
            }
            ParameterId::Surrounding(_) | ParameterId::Effect { .. } => Twist::default(),
            ParameterId::Link { row, parameter } => {
                let own = self.of_row(row);
                own.map_or_else(Twist::default, |own| own.get(parameter))
            }
            ParameterId::Transmission { joint, index } => scaled(
                self.joint_twist(joint),
                self.errors[joint].derivatives[index],
            ),
        }
    }

    /// Derivatives by the numbers of a row of the device; none on another branch than the chosen hand's.
    fn of_row(&self, row: usize) -> Option<&LinkDerivatives> {
        self.link_derivatives
            .get(self.chains.chosen().ok()?.place(row)?)
    }

    /// Derivative of the handle's pose with respect to a joint's output angle (joint from 0): the sum
    /// over the rows that it drives, each times its multiplier. Rows of another branch do not move the hand.
    pub fn joint_twist(&self, joint: usize) -> Twist {
        let along = |row: &LinkDerivatives, motion: JointType| match motion {
            JointType::Prismatic => row.d,
            JointType::Revolute => row.theta,
        };
        if self.device.drives_are_plain() {
            let motion = self.device.joints[joint].joint_type;
            let own = self.of_row(joint + 1);
            return own.map_or_else(Twist::default, |own| along(own, motion));
        }
        let mut sum = Twist::default();
        let drives = self.chains.chosen().map_or(&[][..], DeviceChain::drives);
        for (drive, row) in drives.iter().zip(&self.link_derivatives[1..]) {
            if drive.joint == joint {
                let twist = along(row, drive.motion);
                sum.linear += twist.linear * drive.multiplier;
                sum.angular += twist.angular * drive.multiplier;
            }
        }
        sum
    }

    /// Derivative of the handle's pose with respect to a joint's motor-side reading.
    pub fn reading_twist(&self, joint: usize) -> Twist {
        scaled(self.joint_twist(joint), self.output_slope(joint))
    }
}

fn at_joint(joint: usize) -> impl Fn(LawError) -> ModelError {
    move |source| ModelError::Transmission {
        joint: joint + 1,
        source,
    }
}

fn scaled(twist: Twist, factor: f64) -> Twist {
    Twist {
        linear: twist.linear * factor,
        angular: twist.angular * factor,
    }
}
