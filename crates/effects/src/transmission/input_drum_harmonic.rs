//! Orders of the motor's angle above the first, which the base model has for its input drum.

use crate::context::Context;
use crate::laws::{from_polar, polar, waves};
use crate::{Effect, Family, Follows, Hook, LawError, Parameter, Shape, Signal, Spec, Unit};

/// The error repeats with the turns of the motor.
pub const SPEC: Spec = Spec {
    name: "input-drum-harmonic",
    meaning: "the error repeats with the turns of the motor",
    inspect: "the input drum's run-out, lumps of the cable and the coupling",
    adds: "A cos(k R theta - phase), k = 2, 3, 4",
    source: "A10",
    hook: Hook::Transmission,
    family: Family::Shape,
    parameters: &[
        Parameter::size("amplitude_rad", Unit::Radian, 0.0, 0.05),
        Parameter::phase(),
        Parameter::number("order", 100.0),
    ],
    amplitudes: 2,
    shape: Shape::Listed(&[2.0, 3.0, 4.0]),
    follows: Follows::Angle,
    law_error: LawError::SHAPE,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct InputDrumHarmonic {
    pub(crate) joint: usize,
}

impl Effect for InputDrumHarmonic {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        let ratio = context.device.joints[self.joint].transmission_ratio;
        let readings = &context.recording.joint[self.joint];
        let waves = waves(readings, shape * ratio);
        waves
            .map(|wave| context.upstream(self.joint, &wave))
            .to_vec()
    }

    fn values(&self, _: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        let mut values = polar(amplitudes);
        values.push(shape);
        values
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (from_polar(values), values[2])
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
