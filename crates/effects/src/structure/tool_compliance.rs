//! The handle's fastening gives way along the hand's force.

use nalgebra::Vector3;

use crate::context::Context;
use crate::{Effect, Family, Follows, Hook, LawError, Need, Parameter, Signal, Spec, Unit};

/// The handle or the cable's hook gives way to the force.
pub const SPEC: Spec = Spec {
    name: "tool-compliance",
    meaning: "the handle or the cable's hook gives way to the force",
    inspect: "the connector between the last link and the cable",
    adds: "c F",
    source: "D7, C14",
    hook: Hook::Structure,
    family: Family::Tool,
    needs: &[Need::Chain, Need::Force],
    parameters: &[Parameter::size("m_per_n", Unit::MetrePerNewton, 0.0, 2e-3)],
    follows: Follows::Force,
    is_positive: true,
    law_error: LawError::RIGID,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct ToolCompliance;

impl Effect for ToolCompliance {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let Some(force) = &context.force_n else {
            return vec![];
        };
        vec![context.handle(|row| (force[row], Vector3::zeros()))]
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
