//! One cycle of a haptic device's controller, without std and without an allocator: encoder readings
//! to corrected joint angles, handle pose, and the joint torques that render a force.
#![no_std]
#![forbid(unsafe_code)]

use haptical_kinematics::nalgebra::Vector3;
use haptical_kinematics::{
    Chain, Convention, KinematicsError, Link, Motion, Pose, Twist, joint_torques_nm,
};
use haptical_transmission::{Capstan, CapstanError, CapstanParallelogram, LawError, chebyshev};

/// Joints of the device.
pub const JOINTS: usize = 7;

/// The drive between a motor and its joint.
#[derive(Debug, Clone, Copy)]
pub enum Drive {
    /// The motor sits on the joint.
    Direct,
    /// A cable drive with its identified error.
    Capstan(Capstan, CapstanError),
    /// A cable drive and a parallelogram with their identified errors; deviations in m.
    Parallelogram(CapstanParallelogram, CapstanError, [f64; 4]),
    /// A fitted polynomial: range and coefficients in rad.
    Polynomial([f64; 2], [f64; 11]),
}

/// A calibrated device in memory of fixed size.
#[derive(Debug, Clone)]
pub struct Controller {
    /// Rows of the chain, row 0 first; home is part of `theta_rad`.
    pub links: [Link; JOINTS + 1],
    /// Transmissions of joints 1 to 7.
    pub drives: [Drive; JOINTS],
}

/// What one cycle yields.
#[derive(Debug, Clone, Copy)]
pub struct Cycle {
    /// Angles from home, transmission errors added.
    pub joints_rad: [f64; JOINTS],
    /// Handle in frame (-1).
    pub handle: Pose,
    /// Torques that exert the wanted force on the hand.
    pub torques_nm: [f64; JOINTS],
}

/// Why a cycle has no result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CycleError {
    /// A transmission.
    Transmission {
        /// Joint, from 1.
        joint: usize,
        /// What is wrong.
        source: LawError,
    },
    /// The chain.
    Kinematics(KinematicsError),
}

impl From<KinematicsError> for CycleError {
    fn from(error: KinematicsError) -> Self {
        Self::Kinematics(error)
    }
}

impl Controller {
    /// One cycle: `readings_rad` are motor encoders over the nominal ratios, `force_n` is what the hand
    /// shall feel, in frame (-1).
    ///
    /// # Errors
    /// [`CycleError`] where a transmission or the chain has no value.
    pub fn cycle(
        &self,
        readings_rad: &[f64; JOINTS],
        force_n: [f64; 3],
    ) -> Result<Cycle, CycleError> {
        let mut joints_rad = *readings_rad;
        for (index, (joint_rad, drive)) in joints_rad.iter_mut().zip(&self.drives).enumerate() {
            *joint_rad +=
                drive
                    .error_rad(*joint_rad)
                    .map_err(|source| CycleError::Transmission {
                        joint: index + 1,
                        source,
                    })?;
        }
        let mut motions = [Motion::Revolute; JOINTS + 1];
        motions[0] = Motion::Fixed;
        let chain = Chain::new(Convention::Standard, &self.links, &motions)?;
        let mut jacobian = [Twist::default(); JOINTS];
        let handle = chain.geometric_jacobian(&joints_rad, &mut jacobian)?;
        let mut torques_nm = [0.0; JOINTS];
        let force_n = Vector3::from(force_n);
        joint_torques_nm(&jacobian, &force_n, &Vector3::zeros(), &mut torques_nm)?;
        Ok(Cycle {
            joints_rad,
            handle,
            torques_nm,
        })
    }
}

impl Drive {
    /// Angle to be added to the reading.
    ///
    /// # Errors
    /// Whatever the transmission says of its numbers.
    pub fn error_rad(&self, reading_rad: f64) -> Result<f64, LawError> {
        match self {
            Self::Direct => Ok(0.0),
            Self::Capstan(drive, error) => drive.error(error, reading_rad),
            Self::Parallelogram(drive, error, deviations_m) => {
                drive.error(error, deviations_m, reading_rad)
            }
            Self::Polynomial(range_rad, coefficients_rad) => {
                Ok(chebyshev::evaluate(*range_rad, coefficients_rad, reading_rad).0)
            }
        }
    }
}

/// Stops: a controller that panics must not go on moving motors.
#[panic_handler]
fn stop(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
