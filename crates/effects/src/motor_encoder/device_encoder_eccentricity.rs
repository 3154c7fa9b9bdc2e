//! The first order of the motor's angle, which the base model has for its input drum.

use crate::context::Context;
use crate::laws::{from_polar, polar, waves};
use crate::{
    Absorbed, Effect, Family, Follows, Hook, LawError, Parameter, Shape, Signal, Spec, Unit,
};

/// The disc of a motor encoder sits off its axis.
pub const SPEC: Spec = Spec {
    name: "device-encoder-eccentricity",
    meaning: "the disc of a motor encoder sits off its axis",
    inspect: "the mounting of that encoder",
    adds: "A cos(R theta - phase)",
    source: "A11",
    hook: Hook::Transmission,
    family: Family::Shape,
    parameters: &[
        Parameter::size("amplitude_rad", Unit::Radian, 0.0, 0.1),
        Parameter::phase(),
    ],
    amplitudes: 2,
    shape: Shape::Listed(&[1.0]),
    follows: Follows::Angle,
    absorbed_by: Absorbed::ByInputDrum,
    law_error: LawError::SHAPE,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct DeviceEncoderEccentricity {
    pub(crate) joint: usize,
}

impl Effect for DeviceEncoderEccentricity {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let ratio = context.device.joints[self.joint].transmission_ratio;
        let readings = &context.recording.joint[self.joint];
        let waves = waves(readings, ratio);
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
