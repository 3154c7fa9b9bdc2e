//! The force that a handle exerts when the controller knows the device wrongly.

use haptical_kinematics::nalgebra::{Matrix3, Matrix6, SMatrix, Vector3, Vector6};

use crate::{Evaluation, ModelError};

/// How a wanted wrench of the handle comes out on the true device, at rest, without friction and gravity.
///
/// Wrenches are (force \[N\], moment about the handle \[Nm\]) in frame (-1).
/// Source: docs/equations.md, Force through the transposed Jacobian.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceTransmission {
    /// M = J^-T Jhat^T: what comes out of what is wanted.
    pub matrix: Matrix6<f64>,
    /// Condition number of the true Jacobian of the free joints, lengths in metres.
    pub condition: f64,
}

impl ForceTransmission {
    /// Transmission between a controller's device and the true one, both moved to the same readings, with six
    /// `free` joints (from 0) and the others locked.
    ///
    /// Both Jacobians are with respect to the motor-side readings, so the slopes of the transmissions are part
    /// of them: a ratio that is wrong by 2 % changes a torque by 2 %.
    ///
    /// # Errors
    /// [`ModelError::NoJoint`] for a joint that the devices do not have, [`ModelError::NoLinks`] before a
    /// move, [`ModelError::Posture`] where the true Jacobian is singular.
    ///
    /// ```
    /// use haptical_model::{Device, Evaluation, ForceTransmission};
    /// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
    /// let device = Device::load(path.as_ref())?.device;
    /// let mut truth = Evaluation::new(&device);
    /// truth.move_to(&[0.1, 0.2, 0.0, 0.3, 0.1, 0.2, 0.1])?;
    /// let known = ForceTransmission::new(&truth, &truth, [0, 1, 3, 4, 5, 6])?;
    /// // a device that is known exactly does what is wanted
    /// assert!((known.matrix.trace() - 6.0).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(
        truth: &Evaluation<'_>,
        controller: &Evaluation<'_>,
        free: [usize; 6],
    ) -> Result<Self, ModelError> {
        let jacobian = jacobian(truth, free)?;
        let known = self::jacobian(controller, free)?;
        let condition = condition(&jacobian)?;
        let posture = || ModelError::Posture { condition };
        let matrix = jacobian
            .transpose()
            .lu()
            .solve(&known.transpose())
            .filter(|matrix| matrix.iter().all(|entry| entry.is_finite()))
            .ok_or_else(posture)?;
        Ok(Self { matrix, condition })
    }

    /// What comes out of a wanted wrench.
    pub fn wrench(&self, wanted: &Vector6<f64>) -> Vector6<f64> {
        self.matrix * wanted
    }

    /// What comes out in a closed loop tau = Jhat^T (W + G (W - measured)), at rest:
    /// (1 + G M)^-1 (1 + G) M W. None where the loop has no rest.
    pub fn wrench_in_loop(&self, wanted: &Vector6<f64>, gain: f64) -> Option<Vector6<f64>> {
        let loop_matrix = Matrix6::identity() + self.matrix * gain;
        let right = self.matrix * wanted * (1.0 + gain);
        loop_matrix
            .lu()
            .solve(&right)
            .filter(|wrench| wrench.iter().all(|entry| entry.is_finite()))
    }
}

/// The true device's side of a [`ForceTransmission`] at a posture, for many controllers.
#[derive(Debug, Clone)]
pub struct TrueSide {
    /// J^-T.
    inverse: Matrix6<f64>,
    /// Into the handle's frame.
    turn: Matrix3<f64>,
    free: [usize; 6],
    /// Condition number of the true Jacobian of the free joints, lengths in metres.
    pub condition: f64,
}

impl TrueSide {
    /// Of a device that was moved to a posture; the arguments are those of [`ForceTransmission::new`].
    ///
    /// # Errors
    /// As for [`ForceTransmission::new`].
    pub fn new(truth: &Evaluation<'_>, free: [usize; 6]) -> Result<Self, ModelError> {
        let jacobian = jacobian(truth, free)?;
        let condition = condition(&jacobian)?;
        let posture = || ModelError::Posture { condition };
        let inverse = jacobian.transpose().try_inverse().ok_or_else(posture)?;
        Ok(Self {
            inverse,
            turn: truth.pose()?.rotation.transpose(),
            free,
            condition,
        })
    }

    /// The force in the true handle's frame where a controller wants 1 N along the z of the handle as it knows it, at rest without
    /// a loop: [`handle_force_n`] of gain 0.
    ///
    /// # Errors
    /// [`ModelError::NoLinks`] before a move of the controller's device, [`ModelError::NoJoint`] for a joint that it does not have.
    pub fn unit_force(&self, controller: &Evaluation<'_>) -> Result<Vector3<f64>, ModelError> {
        let along = controller.pose()?.rotation.column(2).into_owned();
        let wanted = Vector6::new(along.x, along.y, along.z, 0.0, 0.0, 0.0);
        let torques = jacobian(controller, self.free)?.tr_mul(&wanted);
        let wrench = self.inverse * torques;
        Ok(self.turn * Vector3::new(wrench[0], wrench[1], wrench[2]))
    }
}

/// The force \[N\] that a sensor in the true handle shows where the controller wants `force_n` along the z of the
/// handle as it knows it, at rest in a loop of gain `gain` (0 without one). None where the loop has no rest.
///
/// Source: docs/equations.md, Force through the transposed Jacobian.
///
/// # Errors
/// [`ModelError::NoLinks`] before a move.
pub fn handle_force_n(
    transmission: &ForceTransmission,
    truth: &Evaluation<'_>,
    controller: &Evaluation<'_>,
    force_n: f64,
    gain: f64,
) -> Result<Option<Vector3<f64>>, ModelError> {
    let along = controller.pose()?.rotation.column(2) * force_n;
    let wanted = Vector6::new(along.x, along.y, along.z, 0.0, 0.0, 0.0);
    let turn = truth.pose()?.rotation.transpose();
    let wrench = transmission.wrench_in_loop(&wanted, gain);
    Ok(wrench.map(|wrench| turn * Vector3::new(wrench[0], wrench[1], wrench[2])))
}

/// Condition number of a Jacobian; an error where it is singular.
fn condition(jacobian: &Matrix6<f64>) -> Result<f64, ModelError> {
    let singular = jacobian.singular_values();
    let (largest, smallest) = (singular.max(), singular.min());
    let condition = largest / smallest;
    match condition.is_finite() && smallest > f64::EPSILON * largest {
        true => Ok(condition),
        false => Err(ModelError::Posture { condition }),
    }
}

/// Columns (linear; angular) of the free joints, with respect to their motor-side readings.
fn jacobian(
    evaluation: &Evaluation<'_>,
    free: [usize; 6],
) -> Result<SMatrix<f64, 6, 6>, ModelError> {
    evaluation.pose()?;
    let joints = evaluation.joint_count();
    if let Some(&joint) = free.iter().find(|joint| **joint >= joints) {
        return Err(ModelError::NoJoint {
            joint: joint + 1,
            joints,
        });
    }
    let mut jacobian = SMatrix::zeros();
    for (column, &joint) in free.iter().enumerate() {
        let twist = evaluation.reading_twist(joint);
        for axis in 0..3 {
            jacobian[(axis, column)] = twist.linear[axis];
            jacobian[(axis + 3, column)] = twist.angular[axis];
        }
    }
    Ok(jacobian)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Device;

    #[test]
    fn the_true_side_gives_the_force_of_the_transmission() {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../fixtures/devices/haptic7.toml"
        );
        let device = Device::load(path.as_ref()).unwrap().device;
        let mut other = device.clone();
        other.links[3].alpha_rad += 0.01;
        let readings = [0.1, 0.2, 0.0, 0.3, 0.1, 0.2, 0.1];
        let free = [0, 1, 3, 4, 5, 6];
        let (mut truth, mut controller) = (Evaluation::new(&device), Evaluation::new(&other));
        truth.move_to(&readings).unwrap();
        controller.move_to(&readings).unwrap();
        let known = ForceTransmission::new(&truth, &controller, free).unwrap();
        let force = handle_force_n(&known, &truth, &controller, 1.0, 0.0);
        let side = TrueSide::new(&truth, free).unwrap();
        let away = side.unit_force(&controller).unwrap() - force.unwrap().unwrap();
        assert!(away.norm() < 1e-12, "{away}");
        assert_eq!(side.condition, known.condition);
        assert!(TrueSide::new(&truth, [0, 1, 3, 4, 5, 9]).is_err());
    }
}
