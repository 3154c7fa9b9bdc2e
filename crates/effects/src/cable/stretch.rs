//! The measuring cable is longer under the tension of its spring.

use crate::context::Context;
use crate::{
    Absorbed, Effect, Family, Follows, Hook, LawError, Need, Parameter, Signal, Spec, Unit,
};

/// The measuring cable is longer under its own tension.
pub const SPEC: Spec = Spec {
    name: "cable-stretch",
    meaning: "the measuring cable is longer under its own tension",
    inspect: "the spring's force and the cable's stiffness",
    adds: "s L",
    source: "C8",
    hook: Hook::CableSensor,
    family: Family::Exit,
    needs: &[Need::Cable],
    parameters: &[Parameter::size("scale", Unit::One, 0.0, 0.05)],
    follows: Follows::ExitAngle,
    absorbed_by: Absorbed::ByLengths,
    look_alikes: &["cable-scale"],
    law_error: LawError::EXIT,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct Stretch;

impl Effect for Stretch {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let Some(cable) = &context.cable else {
            return vec![];
        };
        vec![context.cable_error(cable.length_m.clone())]
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
