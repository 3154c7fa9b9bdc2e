//! The zero of the cable encoder is set wrong.

use crate::context::Context;
use crate::{Effect, Family, Follows, Hook, LawError, Need, Parameter, Signal, Spec, Unit};

/// The zero of the measuring cable is not where the device file says.
pub const SPEC: Spec = Spec {
    name: "cable-zero-offset",
    meaning: "the zero of the measuring cable is not where the device file says",
    inspect: "the reference length of the cable encoder",
    adds: "constant",
    source: "C2",
    hook: Hook::CableSensor,
    family: Family::Exit,
    needs: &[Need::Cable],
    parameters: &[Parameter::size("offset_m", Unit::Metre, 0.0, 0.05)],
    follows: Follows::ExitAngle,
    law_error: LawError::EXIT,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct ZeroOffset;

impl Effect for ZeroOffset {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        vec![context.cable_error(vec![1.0; context.rows()])]
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
