//! The output follows the motor late.

use crate::context::Context;
use crate::laws::{moved, slope};
use crate::{Effect, Family, Follows, Hook, LawError, Need, Parameter, Signal, Spec, Unit};

/// The joint lags behind its motor in proportion to the speed.
pub const SPEC: Spec = Spec {
    name: "viscous-lag",
    meaning: "the joint lags behind its motor in proportion to the speed",
    inspect: "grease, damping and the load of the transmission",
    adds: "theta(t - d) - theta(t)",
    source: "A6",
    hook: Hook::Transmission,
    family: Family::Lag,
    needs: &[Need::Time, Need::Motion],
    parameters: &[Parameter::size("delay_s", Unit::Second, 0.0, 0.05)],
    follows: Follows::Speed,
    is_positive: true,
    law_error: LawError::LAG,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct ViscousLag {
    pub(crate) joint: usize,
}

impl Effect for ViscousLag {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn derivative(&self, context: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<Signal> {
        let motion = context.motion.as_ref().map(|motion| &motion[self.joint]);
        let slope = motion.map(|motion| slope(motion, amplitudes[0]));
        let column = slope.map(|slope| context.upstream(self.joint, &slope));
        vec![column.unwrap_or_default()]
    }

    fn signal(&self, context: &Context<'_>, amplitudes: &[f64], _: f64) -> Signal {
        let motion = context.motion.as_ref().map(|motion| &motion[self.joint]);
        let error = motion.map(|motion| moved(motion, amplitudes[0]));
        let signal = error.map(|error| context.upstream(self.joint, &error));
        signal.unwrap_or_default()
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
