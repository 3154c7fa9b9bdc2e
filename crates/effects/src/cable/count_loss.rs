//! The cable encoder loses counts.

use std::f64::consts::TAU;

use crate::context::Context;
use crate::laws::{instant, row_at, step};
use crate::{Effect, Family, Hook, LawError, Need, Parameter, Shape, Signal, Spec, Unit};

/// The cable encoder lost counts at one moment.
pub const SPEC: Spec = Spec {
    name: "cable-count-loss",
    meaning: "the cable encoder lost counts at one moment",
    inspect: "its plug and supply, and the speed of the cable",
    adds: "steps",
    source: "C12",
    hook: Hook::CableSensor,
    family: Family::Step,
    needs: &[Need::Time, Need::Motion, Need::Cable],
    parameters: &[
        Parameter::size("counts", Unit::One, 0.4, 1e4),
        Parameter::instant(),
    ],
    shape: Shape::Event,
    law_error: LawError::STEP,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct CountLoss;

impl CountLoss {
    /// Size of one count \[m\]; three standard deviations (the paper's rule) where the device file has no counts.
    fn quantum(context: &Context<'_>) -> f64 {
        let device = context.device;
        let cable = device.cables.first();
        let by_counts =
            cable.and_then(|cable| Some(TAU * cable.drum_radius_m? / cable.counts_per_rev?));
        let by_noise = || device.cable_sd_m(0).map(|sd| 3.0 * sd);
        by_counts.or_else(by_noise).unwrap_or(1.0)
    }
}

impl Effect for CountLoss {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        vec![context.cable_error(step(context, shape))]
    }

    fn values(&self, context: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        vec![
            amplitudes[0] / Self::quantum(context),
            instant(context, shape),
        ]
    }

    fn amplitudes(&self, context: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (
            vec![values[0] * Self::quantum(context)],
            row_at(context, values[1]),
        )
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
