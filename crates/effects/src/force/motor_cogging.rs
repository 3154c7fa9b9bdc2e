//! A torque at a multiple of the motor's angle.

use crate::context::Context;
use crate::laws::{from_polar, polar, waves};
use crate::{Effect, Family, Follows, Hook, LawError, Need, Parameter, Signal, Spec, Unit};

/// A torque at a multiple of the motor's angle.
pub const SPEC: Spec = Spec {
    name: "motor-cogging",
    meaning: "the motor's torque ripples as it turns",
    inspect: "the motor and its commutation",
    adds: "A cos(n R theta - phase)",
    source: "E7",
    hook: Hook::Torque,
    family: Family::Shape,
    needs: &[Need::Time, Need::Torque],
    parameters: &[
        Parameter::size("amplitude_nm", Unit::NewtonMetre, 0.0, 0.3).times_ratio(),
        Parameter::phase(),
        Parameter::number("order", f64::MAX),
    ],
    amplitudes: 2,
    follows: Follows::Angle,
    law_error: LawError::SHAPE,
    ..Spec::COMMON
};

/// Highest order that is tried.
pub const COGGING_ORDERS: usize = 12;
/// Periods that the travel must show.
const LEAST_PERIODS: f64 = 2.0;

#[derive(Debug)]
pub(crate) struct MotorCogging {
    pub(crate) joint: usize,
}

impl MotorCogging {
    fn ratio(&self, context: &Context<'_>) -> f64 {
        context.device.joints[self.joint].transmission_ratio
    }
}

impl Effect for MotorCogging {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    /// Orders of which the travel shows periods enough: fewer look like any other function of the angle.
    fn shapes(&self, context: &Context<'_>) -> Vec<f64> {
        let angle = &context.recording.joint[self.joint];
        let low = angle.iter().copied().fold(f64::INFINITY, f64::min);
        let high = angle.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let turns = self.ratio(context).abs() * (high - low) / std::f64::consts::TAU;
        let orders = (1..=COGGING_ORDERS).map(|order| order as f64);
        orders
            .filter(|order| order * turns >= LEAST_PERIODS)
            .collect()
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        let Some(motion) = context.motion.as_ref() else {
            return Vec::new();
        };
        let waves = waves(&motion[self.joint].value, shape * self.ratio(context));
        waves.map(|wave| context.drive(self.joint, wave)).to_vec()
    }

    fn values(&self, _: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        [polar(amplitudes), vec![shape]].concat()
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (from_polar(values), values[2])
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
