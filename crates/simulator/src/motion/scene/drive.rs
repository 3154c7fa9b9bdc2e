//! One joint from the hand's way to the motor's reading and to the output without load.

use haptical_model::transmission::{LawError, invert};
use haptical_model::{Joint, ModelError};

use crate::effect::{Driver, Effect};
use crate::motion::scene::history::{Friction, Play};

/// A play or friction, and which side leads.
#[derive(Debug, Clone, Copy)]
enum Memory {
    Play(Play),
    Friction { of: Friction, amplitude: f64 },
}

impl Memory {
    /// How far the led side stays behind the leading one.
    fn behind(&mut self, leader: f64) -> f64 {
        match self {
            Self::Play(play) => leader - play.follow(leader),
            Self::Friction { of, amplitude } => *amplitude * of.move_to(leader),
        }
    }
}

/// The transmission of one joint with its effects, but for its springs.
#[derive(Debug, Clone)]
pub(crate) struct Drive<'d> {
    joint: &'d Joint,
    /// From 1, for messages.
    number: usize,
    memories: Vec<(Driver, Memory)>,
    /// Most by which the motor may be away from where it would be.
    most_behind: f64,
    lag_s: f64,
    rad_per_s: f64,
    rad_per_k: f64,
    derivatives: Vec<f64>,
    /// Motor-side angle over the ratio.
    pub(crate) motor: f64,
    /// Output without load.
    pub(crate) unloaded: f64,
}

/// An instant: time, and rise of the temperature since the start.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Instant {
    pub(crate) time_s: f64,
    pub(crate) rise_k: f64,
}

impl<'d> Drive<'d> {
    /// The transmission of `joint` at `index`, from 0, with those of the effects that are its own.
    pub(crate) fn new(joint: &'d Joint, index: usize, effects: &[Effect]) -> Self {
        let mut drive = Self {
            joint,
            number: index + 1,
            memories: Vec::new(),
            most_behind: 0.0,
            lag_s: 0.0,
            rad_per_s: 0.0,
            rad_per_k: 0.0,
            derivatives: vec![0.0; joint.error_parameter_count()],
            motor: 0.0,
            unloaded: 0.0,
        };
        for effect in effects {
            if effect.joint() == Some(index + 1) {
                drive.add(effect);
            }
        }
        drive
    }

    fn add(&mut self, effect: &Effect) {
        match *effect {
            Effect::Backlash {
                width_rad,
                driven_by,
                ..
            } => {
                self.most_behind += width_rad;
                let play = Memory::Play(Play::new(width_rad));
                self.memories.push((driven_by, play));
            }
            Effect::Hysteresis {
                amplitude_rad,
                transition_rad,
                driven_by,
                ..
            } => {
                self.most_behind += amplitude_rad;
                let friction = Memory::Friction {
                    of: Friction::new(transition_rad),
                    amplitude: amplitude_rad,
                };
                self.memories.push((driven_by, friction));
            }
            Effect::ViscousLag { delay_s, .. } => self.lag_s += delay_s,
            Effect::JointDrift {
                rad_per_s,
                rad_per_degc,
                ..
            } => {
                self.rad_per_s += rad_per_s.unwrap_or(0.0);
                self.rad_per_k += rad_per_degc.unwrap_or(0.0);
            }
            _ => {}
        }
    }

    /// Moves to the reading that belongs to the hand's way, and its rate.
    ///
    /// Without effects the motor reads `reading` and the output is reading + error(reading). What a
    /// hand leads keeps the output and moves the motor; what a motor leads keeps the motor.
    pub(crate) fn move_to(
        &mut self,
        reading: f64,
        rate: f64,
        at: Instant,
    ) -> Result<(), ModelError> {
        let joint = self.number;
        let refuse = |source| ModelError::Transmission { joint, source };
        let ideal = reading + self.joint.error_rad(reading).map_err(refuse)?;
        let (mut link, mut motor_output) = (ideal, ideal);
        for (driver, memory) in &mut self.memories {
            match driver {
                Driver::Hand => motor_output -= memory.behind(motor_output),
                Driver::Motor => link -= memory.behind(link),
            }
        }
        self.motor = if motor_output == ideal {
            reading
        } else {
            self.reading_of(motor_output, reading).map_err(refuse)?
        };
        if self.lag_s != 0.0 {
            link -= self.lag_s * rate;
        }
        let drift = self.rad_per_s * at.time_s.max(0.0) + self.rad_per_k * at.rise_k;
        self.unloaded = link + drift;
        Ok(())
    }

    /// The motor's reading for an output near that of `reading`.
    fn reading_of(&mut self, output: f64, reading: f64) -> Result<f64, LawError> {
        let (joint, derivatives) = (self.joint, &mut self.derivatives);
        // the output moves by at least half of what the motor does, or the device is no use
        let reach = 2.0 * self.most_behind;
        let bracket = [reading - reach, reading + reach];
        invert(|at| joint.evaluate_error(at, derivatives), output, bracket)
    }
}
