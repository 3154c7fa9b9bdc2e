//! How well numbers predict torques: of the log that they were fitted to, and of one that they have not seen.

use haptical_linalg::dot;
use haptical_model::{Device, FrictionNumber, Recording};

use crate::MotionError;
use crate::arm::Arm;
use crate::fit::problem::{Problem, Reading};
use crate::identify::fit::{Settled, rest};
use crate::identify::friction::FrictionLaw;
use crate::identify::loaded::Loaded;
use crate::identify::numbers::{Number, columns};
use crate::thresholds::identify::POSITION_NOISE;

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

/// What a device leaves of a recording's torques in a band, by its masses, armatures, friction, offsets and delays: joint from 0, root mean
/// square. What its other effects add has to be taken off the torques.
///
/// # Errors
/// As [`identify_dynamics`](super::identify_dynamics); a friction that falls with the speed.
pub fn torques_left(
    device: &Device,
    recording: &Recording,
    edge_hz: f64,
) -> Result<Vec<(usize, f64)>, MotionError> {
    let reading = Reading {
        edge_hz: Some(edge_hz),
        sets_right: true,
        noise_share: POSITION_NOISE,
        ..Reading::default()
    };
    let mut problem = Problem::new(Arm::new(device)?, recording, reading)?;
    problem.reweigh(&vec![1.0; problem.channels.len()]);
    let mut left = problem.recorded(0.0);
    for own in device.effects.iter().filter(|own| own.is_friction()) {
        let Some((joint, joint_type)) = own
            .joint
            .zip(own.joint.map(|joint| device.joints[joint].joint_type))
        else {
            continue;
        };
        let number = |number: FrictionNumber| own.numbers.get(number.key(joint_type)).copied();
        if number(FrictionNumber::Stribeck).is_some_and(|own| own != 0.0) {
            let message = format!("friction of joint {} falls with the speed", joint + 1);
            return Err(MotionError::Fit(message));
        }
        let by_speed = number(FrictionNumber::TurnoverSpeed).map(FrictionLaw::Speed);
        let by_travel = number(FrictionNumber::TurnoverTravel).map(FrictionLaw::Travel);
        let Some(law) = by_speed.or(by_travel) else {
            continue;
        };
        let [dry, viscous] = [FrictionNumber::Coulomb, FrictionNumber::Viscous]
            .map(|own| number(own).unwrap_or(0.0));
        let side = law.side(&problem, joint);
        let pairs = side.iter().zip(&problem.states.motor.dq[joint]);
        let torque: Vec<f64> = pairs.map(|(side, dq)| dry * side + viscous * dq).collect();
        if let Some(column) = problem.of_joint(joint, &torque) {
            column.add_to(&mut left, -1.0);
        }
    }
    let rows = problem.states.rows();
    let of_channel =
        |(own, joint): (&[f64], &usize)| (*joint, (dot(own, own) / rows as f64).sqrt());
    let channels = left.chunks_exact(rows).zip(&problem.channels);
    Ok(channels.map(of_channel).collect())
}
