//! A loop that turns over within a travel, after Dahl, in the transmission.

use crate::context::Context;
use crate::signal::dahl;
use crate::{Effect, Family, Follows, Hook, LawError, Need, Parameter, Shape, Signal, Spec, Unit};

/// Friction bends the transmission, with the sign of the last motion.
pub const SPEC: Spec = Spec {
    name: "hysteresis",
    meaning: "friction bends the transmission, with the sign of the last motion",
    inspect: "bearings, guides and cables that rub",
    adds: "Dahl's loop",
    source: "A5",
    hook: Hook::Transmission,
    family: Family::Loop,
    needs: &[Need::Motion],
    parameters: &[
        Parameter::size("amplitude_rad", Unit::Radian, 0.0, 0.1),
        Parameter::transition("transition_rad", Unit::Radian, 5.0),
    ],
    shape: Shape::Continuous(&[3e-4, 3e-3, 0.01, 0.03, 0.1, 0.3, 1.0]),
    follows: Follows::Angle,
    log_prior: -0.5,
    law_error: LawError::LOOP,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct Hysteresis {
    pub(crate) joint: usize,
}

impl Effect for Hysteresis {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        let state = dahl(&context.recording.joint[self.joint], shape, &context.runs);
        vec![context.upstream(self.joint, &state)]
    }

    fn values(&self, _: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        vec![amplitudes[0].abs(), shape]
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![values[0]], values[1])
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
