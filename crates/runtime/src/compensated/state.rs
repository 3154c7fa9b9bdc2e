//! The result of a step with effects, and the torques that a drive must read for a force on the hand.

use super::at;
use super::torques::DriveTorques;
use crate::{RuntimeError, State};

/// A device with effects at one instant. Vectors are in frame (-1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompensatedState<const JOINTS: usize> {
    /// True joint values, pose of the handle and Jacobian, effects included. The Jacobian is that of the link angles at
    /// the handle's true place; slopes are those of the functions of a joint's own reading, loops taken as carried along.
    pub state: State<JOINTS>,
    /// Angles of the links: the joint values, less what joints yield behind their external encoders.
    pub links: [f64; JOINTS],
    /// Force of the hand on the handle \[N\]: the reading without the errors of the sensor.
    pub hand_force_n: [f64; 3],
    pub(super) torques: DriveTorques<JOINTS>,
}

impl<const JOINTS: usize> CompensatedState<JOINTS> {
    /// Torques that the drives must read, at the joint axes, so that the device exerts a force on the hand:
    /// `(J^T [F; M] + friction + cogging + payload) / (1 - gain)`, in Nm, or in N for a prismatic joint. Times
    /// `state.output_slopes` they are what the readings see.
    ///
    /// `force_n` acts at the handle's origin, `moment_nm` about it, both in frame (-1).
    ///
    /// # Errors
    /// As [`State::joint_torques_nm`].
    #[inline]
    pub fn drive_torques_nm(
        &self,
        force_n: [f64; 3],
        moment_nm: [f64; 3],
    ) -> Result<[f64; JOINTS], RuntimeError> {
        let mut torques_nm = self.state.joint_torques_nm(force_n, moment_nm)?;
        let added = self.torques.added_nm.iter().zip(&self.torques.gain);
        for (index, (torque_nm, (added_nm, gain))) in torques_nm.iter_mut().zip(added).enumerate() {
            *torque_nm = (*torque_nm + added_nm) / (1.0 - gain);
            if !torque_nm.is_finite() {
                return Err(RuntimeError::TorqueOverflow { joint: index + 1 });
            }
        }
        Ok(torques_nm)
    }

    /// Torques that the links get of what the drives read, at the joint axes: the inverse of
    /// [`drive_torques_nm`](Self::drive_torques_nm).
    #[must_use]
    #[inline]
    pub fn link_torques_nm(&self, drive_torques_nm: &[f64; JOINTS]) -> [f64; JOINTS] {
        core::array::from_fn(|joint| {
            let gain = at(&self.torques.gain, joint);
            at(drive_torques_nm, joint) * (1.0 - gain) - at(&self.torques.added_nm, joint)
        })
    }
}
