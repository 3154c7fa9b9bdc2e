//! The zero of a drive follows the temperature.

use crate::context::Context;
use crate::{Effect, Family, Follows, Hook, LawError, Need, Parameter, Signal, Spec, Unit};

/// The joint's zero drifts with time or temperature.
pub const SPEC: Spec = Spec {
    name: "joint-drift",
    meaning: "the joint's zero drifts with time or temperature",
    inspect: "warm-up, and the cable's tension before and after",
    adds: "c (T - mean T)",
    source: "A14",
    hook: Hook::Transmission,
    family: Family::Drift,
    needs: &[Need::Temperature],
    parameters: &[Parameter::size(
        "rad_per_degc",
        Unit::RadianPerKelvin,
        0.0,
        2e-3,
    )],
    follows: Follows::Temperature,
    law_error: LawError::DRIFT,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct JointWarming {
    pub(crate) joint: usize,
}

impl Effect for JointWarming {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let warming = context.warming_k.as_deref().unwrap_or_default();
        vec![context.upstream(self.joint, warming)]
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
