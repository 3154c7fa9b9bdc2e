//! An external encoder is sampled late.

use crate::context::Context;
use crate::laws::{moved, slope};
use crate::{Effect, Family, Follows, Hook, LawError, Need, Parameter, Signal, Spec, Unit};

/// An external encoder is sampled later or earlier than the motor encoders.
pub const SPEC: Spec = Spec {
    name: "external-encoder-latency",
    meaning: "an external encoder is sampled later or earlier than the motor encoders",
    inspect: "the time stamps of its channel",
    adds: "theta(t - d) - theta(t)",
    source: "B5",
    hook: Hook::ExternalEncoder,
    family: Family::Lag,
    needs: &[Need::Time, Need::Motion, Need::Output],
    parameters: &[Parameter::size("delay_s", Unit::Second, 0.0, 0.05)],
    follows: Follows::Speed,
    law_error: LawError::LAG,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct Latency {
    pub(crate) joint: usize,
}

impl Effect for Latency {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn derivative(&self, context: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<Signal> {
        let motion = context.motion.as_ref().map(|motion| &motion[self.joint]);
        let slope = motion.map(|motion| slope(motion, amplitudes[0]));
        let column = slope.map(|slope| context.encoder(self.joint, &slope));
        vec![column.unwrap_or_default()]
    }

    fn signal(&self, context: &Context<'_>, amplitudes: &[f64], _: f64) -> Signal {
        let motion = context.motion.as_ref().map(|motion| &motion[self.joint]);
        let error = motion.map(|motion| moved(motion, amplitudes[0]));
        let signal = error.map(|error| context.encoder(self.joint, &error));
        signal.unwrap_or_default()
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
