//! The output drum has two lobes.

use crate::context::Context;
use crate::laws::{from_polar, polar, waves};
use crate::{Effect, Family, Follows, Hook, LawError, Parameter, Shape, Signal, Spec, Unit};

/// The output drum is not round.
pub const SPEC: Spec = Spec {
    name: "drum-out-of-round",
    meaning: "the output drum is not round",
    inspect: "the drum's run-out with a dial gauge",
    adds: "A cos(2 theta - phase)",
    source: "A7",
    hook: Hook::Transmission,
    family: Family::Shape,
    parameters: &[
        Parameter::size("amplitude_rad", Unit::Radian, 0.0, 0.1),
        Parameter::phase(),
    ],
    amplitudes: 2,
    shape: Shape::Listed(&[1.0]),
    follows: Follows::Angle,
    law_error: LawError::SHAPE,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct DrumOutOfRound {
    pub(crate) joint: usize,
}

impl Effect for DrumOutOfRound {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let readings = &context.recording.joint[self.joint];
        let waves = waves(readings, 2.0);
        waves
            .map(|wave| context.upstream(self.joint, &wave))
            .to_vec()
    }

    fn values(&self, _: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        polar(amplitudes)
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (from_polar(values), 1.0)
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
