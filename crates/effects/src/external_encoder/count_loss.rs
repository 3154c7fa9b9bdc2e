//! An external encoder loses counts.

use std::f64::consts::TAU;

use crate::context::Context;
use crate::laws::{instant, row_at, step};
use crate::{Effect, Family, Hook, LawError, Need, Parameter, Shape, Signal, Spec, Unit};

/// An external encoder lost counts or slipped at one moment.
pub const SPEC: Spec = Spec {
    name: "external-encoder-count-loss",
    meaning: "an external encoder lost counts or slipped at one moment",
    inspect: "its clamp, plug and supply",
    adds: "steps",
    source: "B3",
    hook: Hook::ExternalEncoder,
    family: Family::Step,
    needs: &[Need::Time, Need::Motion, Need::Output],
    parameters: &[
        Parameter::size("counts", Unit::One, 0.4, 1e4),
        Parameter::instant(),
    ],
    shape: Shape::Event,
    law_error: LawError::STEP,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct CountLoss {
    pub(crate) joint: usize,
}

impl CountLoss {
    /// Size of one count; three standard deviations (the paper's rule) where the device file has no counts.
    fn quantum(&self, context: &Context<'_>) -> f64 {
        let joint = &context.device.joints[self.joint];
        let counts = joint.external_encoder_counts_per_rev;
        let by_counts = counts.map(|counts| TAU / counts);
        let by_noise = || joint.output_sd_rad().map(|sd| 3.0 * sd);
        by_counts.or_else(by_noise).unwrap_or(1.0)
    }
}

impl Effect for CountLoss {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        vec![context.encoder(self.joint, &step(context, shape))]
    }

    fn values(&self, context: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        vec![
            amplitudes[0] / self.quantum(context),
            instant(context, shape),
        ]
    }

    fn amplitudes(&self, context: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (
            vec![values[0] * self.quantum(context)],
            row_at(context, values[1]),
        )
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
