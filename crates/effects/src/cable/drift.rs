//! The zero of the cable encoder drifts in time.

use crate::context::Context;
use crate::laws::{COURSES, course};
use crate::{Effect, Family, Hook, LawError, Need, Parameter, Shape, Signal, Spec, Unit};

/// The cable encoder's zero drifts with time.
pub const SPEC: Spec = Spec {
    name: "cable-drift",
    meaning: "the cable encoder's zero drifts with time",
    inspect: "warm-up of the encoder, and creep of the cable",
    adds: "c t",
    source: "C10",
    hook: Hook::CableSensor,
    family: Family::Drift,
    needs: &[Need::Time, Need::Cable],
    parameters: &[Parameter::size("m_per_s", Unit::MetrePerSecond, 0.0, 1e-4)],
    shape: Shape::Listed(&COURSES),
    law_error: LawError::DRIFT,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct Drift;

impl Effect for Drift {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        vec![context.cable_error(course(context, shape))]
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
