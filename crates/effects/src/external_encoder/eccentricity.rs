//! The disc of an external encoder is off its axis.

use crate::context::Context;
use crate::laws::{from_polar, polar, waves};
use crate::{Effect, Family, Follows, Hook, LawError, Need, Parameter, Shape, Signal, Spec, Unit};

/// The disc of an external encoder sits off the axis.
pub const SPEC: Spec = Spec {
    name: "external-encoder-eccentricity",
    meaning: "the disc of an external encoder sits off the axis",
    inspect: "the mounting of that encoder",
    adds: "A cos(theta - phase)",
    source: "B1",
    hook: Hook::ExternalEncoder,
    family: Family::Shape,
    needs: &[Need::Output],
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
pub(crate) struct Eccentricity {
    pub(crate) joint: usize,
}

impl Effect for Eccentricity {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let readings = &context.recording.joint[self.joint];
        let waves = waves(readings, 1.0);
        waves
            .map(|wave| context.encoder(self.joint, &wave))
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
