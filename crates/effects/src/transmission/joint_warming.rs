//! The zero of a drive follows the temperature.

use crate::laws::{Input, Law};
use crate::{Family, Follows, Hook, LawError, Need, Parameter, Spec, Unit};

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
pub(crate) struct JointWarming;

impl Law for JointWarming {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], _: f64) -> Option<Vec<Vec<f64>>> {
        Some(vec![input.context.warming_k.clone()?])
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
