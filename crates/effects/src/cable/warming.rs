//! The cable and its encoder grow with temperature.

use crate::context::Context;
use crate::{Effect, Family, Follows, Hook, LawError, Need, Parameter, Signal, Spec, Unit};

/// Lengths grow with the temperature.
pub const SPEC: Spec = Spec {
    name: "thermal-drift",
    meaning: "lengths grow with the temperature",
    inspect: "warm-up, and the temperature of the room",
    adds: "growth of cable and encoder, see above",
    source: "C9",
    hook: Hook::CableSensor,
    family: Family::Drift,
    needs: &[Need::Temperature, Need::Cable],
    parameters: &[Parameter::size(
        "m_per_degc",
        Unit::MetrePerKelvin,
        0.0,
        3e-4,
    )],
    amplitudes: 2,
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

    /// A shift at the mean distance (housing and cable), and what grows with the distance beyond that.
    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let (Some(warming), Some(cable)) = (&context.warming_k, &context.cable) else {
            return vec![];
        };
        let mean = context.mean_length_m();
        let beyond = warming.iter().zip(&cable.length_m);
        let beyond = beyond.map(|(warming, length)| warming * (length / mean - 1.0));
        vec![
            context.cable_error(warming.clone()),
            context.cable_error(beyond.collect()),
        ]
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
