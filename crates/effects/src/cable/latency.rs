//! The cable encoder is sampled late.

use crate::context::Context;
use crate::laws::{moved, slope};
use crate::signal::LocalMotion;
use crate::{Effect, Family, Follows, Hook, LawError, Need, Parameter, Signal, Spec, Unit};

/// The cable encoder is sampled later or earlier than the joints.
pub const SPEC: Spec = Spec {
    name: "cable-latency",
    meaning: "the cable encoder is sampled later or earlier than the joints",
    inspect: "the time stamps of its channel",
    adds: "L(t - d) - L(t)",
    source: "C13",
    hook: Hook::CableSensor,
    family: Family::Lag,
    needs: &[Need::Time, Need::Motion, Need::Cable],
    parameters: &[Parameter::size("delay_s", Unit::Second, 0.0, 0.05)],
    follows: Follows::CableSpeed,
    law_error: LawError::LAG,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct Latency;

/// How the cable's length changes, where times are recorded.
fn motion<'c>(context: &'c Context<'_>) -> Option<&'c LocalMotion> {
    let motion = &context.cable.as_ref()?.motion;
    (!motion.velocity.is_empty()).then_some(motion)
}

impl Effect for Latency {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn derivative(&self, context: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<Signal> {
        let slope = motion(context).map(|motion| slope(motion, amplitudes[0]));
        let column = slope.map(|slope| context.cable_error(slope));
        vec![column.unwrap_or_default()]
    }

    fn signal(&self, context: &Context<'_>, amplitudes: &[f64], _: f64) -> Signal {
        let error = motion(context).map(|motion| moved(motion, amplitudes[0]));
        let signal = error.map(|error| context.cable_error(error));
        signal.unwrap_or_default()
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
