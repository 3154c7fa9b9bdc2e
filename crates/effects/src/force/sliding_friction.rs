//! Friction that a drive overcomes: Coulomb's, which changes sides over a rate, viscous, and Stribeck's at low rates.

use crate::context::Context;
use crate::laws::{rubbing, takes_energy};
use crate::{Effect, Family, Follows, Hook, LawError, Need, Parameter, Shape, Signal, Spec, Unit};

/// Friction that a drive overcomes: Coulomb's, which changes sides over a rate, viscous, and Stribeck's at low rates.
pub const SPEC: Spec = Spec {
    name: "joint-friction",
    meaning: "a joint's friction is missing in the torque",
    inspect: "bearings and cable of the joint",
    adds: "h, omega, h exp(-(omega / 0.1)^2), h = tanh(omega / v)",
    source: "E6",
    hook: Hook::Torque,
    family: Family::Loop,
    needs: &[Need::Time, Need::Torque],
    parameters: &[
        Parameter::size("coulomb_nm", Unit::NewtonMetre, 0.0, 0.3).times_ratio(),
        Parameter::size(
            "viscous_nm_s_per_rad",
            Unit::NewtonMetreSecondPerRadian,
            0.0,
            f64::MAX,
        ),
        Parameter::size("stribeck_nm", Unit::NewtonMetre, 0.0, f64::MAX),
        Parameter::transition("transition_rad_per_s", Unit::RadianPerSecond, f64::MAX),
    ],
    amplitudes: 3,
    shape: Shape::Continuous(&[0.02]),
    follows: Follows::Speed,
    law_error: LawError::SHAPE,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct SlidingFriction {
    pub(crate) joint: usize,
}

impl Effect for SlidingFriction {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        let Some(motion) = context.drive_motion(self.joint) else {
            return Vec::new();
        };
        let side = motion
            .velocity
            .iter()
            .map(|rate| (rate / shape).tanh())
            .collect();
        let columns = rubbing(side, motion.velocity);
        columns
            .map(|column| context.drive(self.joint, column))
            .to_vec()
    }

    fn is_possible(&self, context: &Context<'_>, amplitudes: &[f64]) -> bool {
        context
            .drive_motion(self.joint)
            .is_some_and(|motion| takes_energy(&motion.velocity, amplitudes))
    }

    fn values(&self, _: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        [amplitudes, &[shape]].concat()
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (values[..3].to_vec(), values[3])
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
