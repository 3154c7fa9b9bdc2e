//! A joint or link yields behind the external encoder by torque over stiffness.

use crate::context::Context;
use crate::{
    Absorbed, Effect, Family, Follows, Hook, LawError, Need, Parameter, Signal, Spec, Unit,
};

/// A joint or link bends with its torque, behind the external encoder.
pub const SPEC: Spec = Spec {
    name: "joint-compliance",
    meaning: "a joint or link bends with its torque, behind the external encoder",
    inspect: "bearings, clamps and the link's stiffness",
    adds: "-tau / k",
    source: "D1, D2",
    hook: Hook::Joint,
    family: Family::Load,
    needs: &[Need::Torque, Need::Chain],
    parameters: &[Parameter::inverse(
        "stiffness_nm_per_rad",
        Unit::NewtonMetrePerRadian,
        20.0,
        1e7,
    )],
    follows: Follows::Torque,
    is_positive: true,
    scales_with_torque: true,
    absorbed_by: Absorbed::ByCompliance,
    law_error: LawError::LOAD,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct JointCompliance {
    pub(crate) joint: usize,
}

impl Effect for JointCompliance {
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
        vec![context.downstream(self.joint, &error)]
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
