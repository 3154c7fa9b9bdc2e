//! Torques of the drives and forces of the sensor: what they read that no link needs and no hand exerts.

use haptical_kinematics::Twist;
use haptical_kinematics::nalgebra::Vector3;
use haptical_transmission::loops::Dahl;

use super::drives::waves;
use super::memory::{Memory, foreign};
use super::{Inputs, add, at};
use crate::{Effect, RuntimeError, Turnover};

/// What the torques of the drives have beside what the links need.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DriveTorques<const JOINTS: usize> {
    /// Friction, cogging, payload.
    pub(super) added_nm: [f64; JOINTS],
    /// Part of the reading that is too much.
    pub(super) gain: [f64; JOINTS],
}

impl<const JOINTS: usize> DriveTorques<JOINTS> {
    pub(super) const NONE: Self = Self {
        added_nm: [0.0; JOINTS],
        gain: [0.0; JOINTS],
    };

    /// Adds what one effect does.
    #[inline]
    pub(super) fn take(
        &mut self,
        index: usize,
        effect: &Effect,
        inputs: &Inputs<JOINTS>,
        jacobian: &[Twist; JOINTS],
        memory: &mut Memory,
    ) -> Result<(), RuntimeError> {
        match *effect {
            Effect::TorqueGain { joint, gain } => add(&mut self.gain, joint, gain),
            Effect::Friction {
                joint,
                coulomb_nm,
                viscous_nm_s_per_rad,
                stribeck_nm,
                stribeck_rad_per_s,
                side,
            } => {
                let rate = at(&inputs.velocity, joint);
                let side = match side {
                    Turnover::Rate(rate_at) => libm::tanh(rate / rate_at),
                    Turnover::Travel(transition) => {
                        let Memory::Dahl(dahl) = memory else {
                            return Err(foreign(index));
                        };
                        dahl.step(transition, at(&inputs.readings, joint))
                    }
                };
                let slow = rate / stribeck_rad_per_s;
                let slow = libm::exp(-(slow * slow));
                let friction =
                    coulomb_nm * side + viscous_nm_s_per_rad * rate + stribeck_nm * (side * slow);
                add(&mut self.added_nm, joint, friction);
            }
            Effect::MotorCogging {
                joint,
                periods,
                cosine_nm,
                sine_nm,
            } => {
                let (sine, cosine) = waves(joint, periods, at(&inputs.readings, joint))?;
                let cogging = cosine_nm * cosine + sine_nm * sine;
                add(&mut self.added_nm, joint, cogging);
            }
            Effect::Payload {
                mass_kg,
                gravity_mps2,
            } => {
                let acceleration = Vector3::from(inputs.handle_acceleration_mps2);
                let pull_n = (acceleration - Vector3::from(gravity_mps2)) * mass_kg;
                for (added_nm, column) in self.added_nm.iter_mut().zip(jacobian) {
                    *added_nm += column.linear.dot(&pull_n);
                }
            }
            _ => {}
        }
        Ok(())
    }
}

/// Parts of the axes that read too much, and whose force it is: as the fields of [`Effect::ForceCrosstalk`].
const CROSSTALK: [(usize, usize); 6] = [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)];

/// What one effect of the force sensor reads beyond the hand's force, in the handle's axes; none for one of another kind.
#[inline]
pub(super) fn sensor_error_n<const JOINTS: usize>(
    index: usize,
    effect: &Effect,
    inputs: &Inputs<JOINTS>,
    memory: &mut Memory,
) -> Result<Option<Vector3<f64>>, RuntimeError> {
    let read_n = Vector3::from(inputs.force_n);
    Ok(Some(match effect {
        Effect::ForceBias { bias_n } => Vector3::from(*bias_n),
        Effect::ForceWarmBias {
            n_per_degc,
            reference_degc,
        } => Vector3::from(*n_per_degc) * (inputs.temperature_degc - reference_degc),
        // what is read is 1 + gain times what acts
        Effect::ForceGain { gain } => {
            Vector3::from(*gain).zip_map(&read_n, |gain, read| read * (gain / (1.0 + gain)))
        }
        Effect::ForceCrosstalk { parts } => {
            let mut error_n = [0.0; 3];
            for ((to, from), part) in CROSSTALK.into_iter().zip(parts) {
                add(&mut error_n, to, part * at(&inputs.force_n, from));
            }
            Vector3::from(error_n)
        }
        Effect::ForceHysteresis {
            size_n,
            transition_n,
        } => {
            let Memory::Axes(axes) = memory else {
                return Err(foreign(index));
            };
            let mut error_n = [0.0; 3];
            let axes: &mut [Dahl; 3] = axes;
            let forces = axes.iter_mut().zip(&inputs.force_n).zip(size_n);
            for (error, ((axis, force), size)) in error_n.iter_mut().zip(forces) {
                *error = size * axis.step(*transition_n, *force);
            }
            Vector3::from(error_n)
        }
        _ => return Ok(None),
    }))
}
