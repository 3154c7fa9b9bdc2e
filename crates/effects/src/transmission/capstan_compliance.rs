//! The cable of a capstan stretches: in front of its external encoder the joint stays behind by torque over
//! stiffness.

use crate::context::Context;
use crate::{Effect, Family, Follows, Hook, LawError, Need, Parameter, Signal, Spec, Unit};

/// The capstan's cable stretches with the torque.
pub const SPEC: Spec = Spec {
    name: "capstan-compliance",
    meaning: "the capstan's cable stretches with the torque",
    inspect: "the pre-tension, diameter and free length of that cable",
    adds: "-tau / k",
    source: "A1",
    hook: Hook::Transmission,
    family: Family::Load,
    needs: &[Need::Torque, Need::Output],
    parameters: &[Parameter::inverse(
        "stiffness_nm_per_rad",
        Unit::NewtonMetrePerRadian,
        20.0,
        1e7,
    )],
    follows: Follows::Torque,
    is_positive: true,
    scales_with_torque: true,
    law_error: LawError::LOAD,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct CapstanCompliance {
    pub(crate) joint: usize,
}

impl Effect for CapstanCompliance {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let Some(torque) = context.torque_nm.get(self.joint).and_then(Option::as_ref) else {
            return vec![];
        };
        let error: Vec<f64> = torque.iter().map(|torque| -torque).collect();
        vec![context.upstream(self.joint, &error)]
    }

    fn values(&self, _: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        vec![1.0 / amplitudes[0]]
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![1.0 / values[0]], 0.0)
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
