//! All links grow with temperature: the way from base to handle does.

use nalgebra::Vector3;

use crate::context::Context;
use crate::{Effect, Family, Follows, Hook, LawError, Need, Parameter, Signal, Spec, Unit};

/// Lengths grow with the temperature.
pub const SPEC: Spec = Spec {
    name: "thermal-drift",
    meaning: "lengths grow with the temperature",
    inspect: "warm-up, and the temperature of the room",
    adds: "growth of all links, see above",
    source: "D8",
    hook: Hook::Structure,
    family: Family::Drift,
    needs: &[Need::Temperature, Need::Chain],
    parameters: &[Parameter::size(
        "m_per_degc",
        Unit::MetrePerKelvin,
        0.0,
        3e-4,
    )],
    follows: Follows::Temperature,
    law_error: LawError::DRIFT,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct Warming;

impl Effect for Warming {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let Some(warming) = &context.warming_k else {
            return vec![];
        };
        let mean = context.mean_length_m();
        vec![context.handle(|row| {
            let grown = context.way_from_base(row) * (warming[row] / mean);
            (grown, Vector3::zeros())
        })]
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
