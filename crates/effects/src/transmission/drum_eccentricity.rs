//! An eccentric drive of a joint for which the base model has none.

use crate::context::Context;
use crate::laws::{from_polar, polar, waves};
use crate::{
    Absorbed, Effect, Family, Follows, Hook, LawError, Need, Parameter, Shape, Signal, Spec, Unit,
};

/// A drum turns off its centre.
pub const SPEC: Spec = Spec {
    name: "drum-eccentricity",
    meaning: "a drum turns off its centre",
    inspect: "the drum's run-out with a dial gauge",
    adds: "A cos(theta - phase)",
    source: "D4",
    hook: Hook::Transmission,
    family: Family::Shape,
    needs: &[Need::Chain],
    parameters: &[
        Parameter::size("amplitude_rad", Unit::Radian, 0.0, 0.1),
        Parameter::phase(),
    ],
    amplitudes: 2,
    shape: Shape::Listed(&[1.0]),
    follows: Follows::Angle,
    absorbed_by: Absorbed::ByTransmission,
    law_error: LawError::SHAPE,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct DrumEccentricity {
    pub(crate) joint: usize,
}

impl Effect for DrumEccentricity {
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
