//! How well numbers predict torques: of the log that they were fitted to, and of one that they have not seen.

use haptical_linalg::dot;
use haptical_model::Recording;

use crate::MotionError;
use crate::arm::Arm;
use crate::fit::problem::{Problem, Reading};
use crate::identify::fit::{Settled, rest};
use crate::identify::loaded::Loaded;
use crate::identify::numbers::{Number, columns};

/// A joint's torque, measured and predicted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// Joint, from 0.
    pub joint: usize,
    /// Root mean square of the measured torque in the band \[N m\], \[N\].
    pub torque_rms: f64,
    /// That of what the device as it was leaves.
    pub before_rms: f64,
    /// That of what the feasible set leaves.
    pub after_rms: f64,
    /// That of what the base parameters leave, which need not belong to any body.
    pub base_rms: f64,
}

impl Residual {
    /// `||tau - model|| / ||tau||` in per cent.
    pub fn percent(&self) -> f64 {
        100.0 * self.after_rms / self.torque_rms
    }
}

/// Numbers as deviations from a device's, by which a prediction is made.
pub(crate) struct Numbers<'a> {
    pub(crate) numbers: &'a [Number],
    pub(crate) settled: &'a Settled,
    pub(crate) loaded: &'a Loaded,
    /// Of a feasible set, and of base parameters.
    pub(crate) feasible: &'a [f64],
    pub(crate) base: &'a [f64],
}

impl Numbers<'_> {
    /// What they leave of a problem's torques.
    pub(crate) fn residuals(&self, problem: &mut Problem) -> Vec<Residual> {
        problem.reweigh(&vec![1.0; problem.channels.len()]);
        let Settled {
            friction, early_s, ..
        } = self.settled;
        let all = columns(problem, self.numbers, friction, *early_s);
        let target = problem.recorded(*early_s);
        let [after, base] = [self.feasible, self.base].map(|own| rest(&target, &all, own));
        let before = problem.recorded(0.0);
        let rows = problem.states.rows();
        let rms = |own: &[f64], channel: usize| {
            let own = &own[channel * rows..][..rows];
            (dot(own, own) / rows as f64).sqrt()
        };
        let of = |(channel, joint): (usize, &usize)| {
            let torque = problem.states.torque(&problem.samples, *joint, *early_s);
            Residual {
                joint: *joint,
                torque_rms: rms(&torque, 0),
                before_rms: rms(&before, channel),
                after_rms: rms(&after, channel),
                base_rms: rms(&base, channel),
            }
        };
        problem.channels.iter().enumerate().map(of).collect()
    }

    /// The same of another recording, in the same band.
    pub(crate) fn on(
        &self,
        arm: &Arm,
        recording: &Recording,
        reading: Reading,
    ) -> Result<Vec<Residual>, MotionError> {
        let mut problem = Problem::new(arm.clone(), recording, reading)?;
        let needed = self.numbers.iter().filter_map(|number| match number {
            Number::Offset { joint } => Some(*joint),
            _ => None,
        });
        for joint in needed {
            if !problem.channels.contains(&joint) {
                return Err(MotionError::Missing {
                    what: format!("torque of joint {}", joint + 1),
                    why: "the fitted log has it",
                });
            }
        }
        if let Some(arm) = &self.loaded.arm {
            problem.carry(arm)?;
        }
        Ok(self.residuals(&mut problem))
    }
}
