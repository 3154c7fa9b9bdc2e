//! Errors of joint angles: what a joint's true value has more than the model of its transmission says.

use haptical_kinematics::trigonometry::{LARGEST_RAD, sine_cosine};
use haptical_transmission::loops::{SMALLEST_HALF_WIDTH, delayed, settled};
use haptical_transmission::spline::curve;

use super::memory::{Memory, foreign};
use super::{Inputs, at};
use crate::{Effect, Over, RuntimeError, Side};

/// An error of a joint's angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DriveError {
    pub(super) joint: usize,
    pub(super) value: f64,
    /// Its derivative with respect to the joint's own reading, where it is a function of it.
    pub(super) slope: f64,
}

impl DriveError {
    const fn of(joint: usize, value: f64) -> Self {
        Self {
            joint,
            value,
            slope: 0.0,
        }
    }
}

impl Effect {
    /// Whether the effect is an error of this joint's angle, among others.
    pub(super) const fn moves_drive(&self, own: usize) -> bool {
        match *self {
            Self::EncoderLatency { .. } => true,
            Self::CapstanCompliance { joint, .. }
            | Self::Backlash { joint, .. }
            | Self::Hysteresis { joint, .. }
            | Self::CapstanCreep { joint, .. }
            | Self::ViscousLag { joint, .. }
            | Self::Harmonic { joint, .. }
            | Self::CablePitch { joint, .. }
            | Self::Coupling { joint, .. }
            | Self::CoupledBacklash { joint, .. }
            | Self::Drift { joint, .. }
            | Self::SettlingDrift { joint, .. }
            | Self::WarmDrift { joint, .. }
            | Self::Curve { joint, .. } => joint == own,
            _ => false,
        }
    }

    /// The error of one joint's angle at the next sample; none for an effect of another kind, and for the latency, which
    /// is of every joint. `outputs` are the joints' values by their transmissions.
    #[inline]
    pub(super) fn drive_error<const JOINTS: usize>(
        &self,
        index: usize,
        inputs: &Inputs<JOINTS>,
        outputs: &[f64; JOINTS],
        memory: &mut Memory,
    ) -> Result<Option<DriveError>, RuntimeError> {
        let reading = |joint: usize| at(&inputs.readings, joint);
        Ok(Some(match *self {
            Self::CapstanCompliance { joint, rad_per_nm } => {
                DriveError::of(joint, -rad_per_nm * at(&inputs.torque_nm, joint))
            }
            Self::ViscousLag { joint, delay_s } => {
                DriveError::of(joint, inputs.delayed(joint, delay_s))
            }
            Self::Harmonic {
                joint,
                periods,
                cosine_rad,
                sine_rad,
            } => {
                let (sine, cosine) = waves(joint, periods, reading(joint))?;
                DriveError {
                    joint,
                    value: cosine_rad * cosine + sine_rad * sine,
                    slope: periods * (sine_rad * cosine - cosine_rad * sine),
                }
            }
            Self::CablePitch {
                joint,
                quadratic_per_rad,
                cubic_per_rad2,
            } => {
                let q = reading(joint);
                DriveError {
                    joint,
                    value: quadratic_per_rad * (q * q) + cubic_per_rad2 * (q * q * q),
                    slope: (2.0 * quadratic_per_rad + 3.0 * cubic_per_rad2 * q) * q,
                }
            }
            Self::Coupling { joint, from, gain } => DriveError {
                joint,
                value: gain * reading(from),
                slope: if from == joint { gain } else { 0.0 },
            },
            Self::Drift { joint, rad_per_s } => DriveError::of(joint, rad_per_s * inputs.time_s),
            Self::SettlingDrift {
                joint,
                end_rad,
                time_constant_s,
            } => DriveError::of(joint, end_rad * settled(inputs.time_s, time_constant_s)),
            Self::WarmDrift {
                joint,
                rad_per_degc,
                reference_degc,
            } => {
                let warming = inputs.temperature_degc - reference_degc;
                DriveError::of(joint, rad_per_degc * warming)
            }
            Self::Curve {
                joint,
                over,
                lower,
                upper,
                coefficients,
            } => {
                let place = match over {
                    Over::Angle => reading(joint),
                    Over::Torque => at(&inputs.torque_nm, joint),
                    Over::Temperature => inputs.temperature_degc,
                    Over::Time => inputs.time_s,
                };
                // the model was made with a range and enough coefficients
                let (value, slope) = curve(place, lower, upper, coefficients).unwrap_or_default();
                let slope = if over == Over::Angle { slope } else { 0.0 };
                DriveError {
                    joint,
                    value,
                    slope,
                }
            }
            _ => return self.loop_error(index, inputs, outputs, memory),
        }))
    }

    /// The same of an effect with a memory.
    #[inline]
    fn loop_error<const JOINTS: usize>(
        &self,
        index: usize,
        inputs: &Inputs<JOINTS>,
        outputs: &[f64; JOINTS],
        memory: &mut Memory,
    ) -> Result<Option<DriveError>, RuntimeError> {
        let reading = |joint: usize| at(&inputs.readings, joint);
        Ok(Some(match *self {
            Self::Backlash {
                joint, width_rad, ..
            } => {
                let half_rad = 0.5 * width_rad;
                let side = match memory {
                    Memory::Play(play) => {
                        play.step(half_rad.max(SMALLEST_HALF_WIDTH), reading(joint))
                    }
                    // pushed by its joint, a motor is that much behind it
                    Memory::Dahl(sign) => sign.step(0.0, at(outputs, joint)),
                    _ => return Err(foreign(index)),
                };
                DriveError::of(joint, half_rad * side)
            }
            Self::Hysteresis {
                joint,
                amplitude_rad,
                transition_rad,
                driven_by,
            } => {
                let Memory::Dahl(dahl) = memory else {
                    return Err(foreign(index));
                };
                let side = dahl.step(transition_rad, at(outputs, joint));
                let amplitude_rad = match driven_by {
                    Side::Motor => -amplitude_rad,
                    Side::Hand => amplitude_rad,
                };
                DriveError::of(joint, amplitude_rad * side)
            }
            Self::CapstanCreep {
                joint,
                creep_per_nm,
            } => {
                let Memory::Creep(creep) = memory else {
                    return Err(foreign(index));
                };
                let crept = creep.step(at(&inputs.torque_nm, joint), reading(joint));
                DriveError::of(joint, creep_per_nm * crept)
            }
            Self::CoupledBacklash {
                joint,
                from,
                width_rad,
                play_rad,
            } => {
                let Memory::Play(play) = memory else {
                    return Err(foreign(index));
                };
                let lost = play.step(0.5 * play_rad, reading(from));
                DriveError::of(joint, width_rad / play_rad * lost)
            }
            _ => return Ok(None),
        }))
    }
}

impl<const JOINTS: usize> Inputs<JOINTS> {
    /// How far a joint's reading was behind, a delay ago.
    #[inline]
    pub(super) fn delayed(&self, joint: usize, delay_s: f64) -> f64 {
        let (velocity, acceleration) = (at(&self.velocity, joint), at(&self.acceleration, joint));
        delayed(delay_s, velocity, acceleration)
    }
}

/// Sine and cosine of a multiple of a joint's angle.
#[inline]
pub(super) fn waves(
    joint: usize,
    periods: f64,
    angle_rad: f64,
) -> Result<(f64, f64), RuntimeError> {
    let phase_rad = periods * angle_rad;
    // NaN is not inside either
    if phase_rad.abs() <= LARGEST_RAD {
        return Ok(sine_cosine(phase_rad));
    }
    let upper = LARGEST_RAD / periods.abs();
    Err(RuntimeError::ReadingOutOfRange {
        joint: joint + 1,
        reading: angle_rad,
        lower: -upper,
        upper,
    })
}
