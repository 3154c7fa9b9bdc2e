//! The measuring drum's radius is not the stated one.

use crate::context::Context;
use crate::{
    Absorbed, Effect, Family, Follows, Hook, LawError, Need, Parameter, Signal, Spec, Unit,
};

/// The measuring drum's radius is not the stated one.
pub const SPEC: Spec = Spec {
    name: "cable-scale",
    meaning: "the measuring drum's radius is not the stated one",
    inspect: "the drum with a length standard",
    adds: "s L",
    source: "C1",
    hook: Hook::CableSensor,
    family: Family::Exit,
    needs: &[Need::Cable],
    parameters: &[Parameter::size("scale", Unit::One, 0.0, 0.05)],
    follows: Follows::ExitAngle,
    absorbed_by: Absorbed::ByLengths,
    look_alikes: &["cable-stretch"],
    law_error: LawError::EXIT,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct Scale;

impl Effect for Scale {
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
