//! The zero of an external encoder drifts in time.

use crate::context::Context;
use crate::laws::{COURSES, course};
use crate::{Effect, Family, Hook, LawError, Need, Parameter, Shape, Signal, Spec, Unit};

/// The zero of an external encoder drifts.
pub const SPEC: Spec = Spec {
    name: "external-encoder-drift",
    meaning: "the zero of an external encoder drifts",
    inspect: "its clamp, and its temperature",
    adds: "c t",
    source: "B4",
    hook: Hook::ExternalEncoder,
    family: Family::Drift,
    needs: &[Need::Time, Need::Output],
    parameters: &[Parameter::size(
        "rad_per_s",
        Unit::RadianPerSecond,
        0.0,
        5e-4,
    )],
    shape: Shape::Listed(&COURSES),
    law_error: LawError::DRIFT,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct Drift {
    pub(crate) joint: usize,
}

impl Effect for Drift {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        vec![context.encoder(self.joint, &course(context, shape))]
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
