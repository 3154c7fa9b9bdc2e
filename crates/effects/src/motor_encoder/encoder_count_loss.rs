//! A motor encoder loses counts: by these its reading is too high afterwards, and the measured channels, which are
//! compared with it, are too low.

use crate::context::Context;
use crate::laws::{instant, row_at, step};
use crate::{Effect, Family, Hook, LawError, Need, Parameter, Shape, Signal, Spec, Unit};

/// A motor encoder lost counts at one moment.
pub const SPEC: Spec = Spec {
    name: "encoder-count-loss",
    meaning: "a motor encoder lost counts at one moment",
    inspect: "plug, shield and supply of that encoder, and its counter's input filter",
    adds: "steps",
    source: "A9",
    hook: Hook::Transmission,
    family: Family::Step,
    needs: &[Need::Time, Need::Motion, Need::Counts],
    parameters: &[
        Parameter::size("counts", Unit::One, 0.4, 1e4),
        Parameter::instant(),
    ],
    shape: Shape::Event,
    law_error: LawError::STEP,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct EncoderCountLoss {
    pub(crate) joint: usize,
}

impl EncoderCountLoss {
    /// Size of one count \[rad\], or \[m\] of a slide; 1 where the device file has none.
    fn quantum(&self, context: &Context<'_>) -> f64 {
        let joint = &context.device.joints[self.joint];
        joint.reading_quantum_rad().unwrap_or(1.0)
    }
}

impl Effect for EncoderCountLoss {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        vec![context.upstream(self.joint, &step(context, shape))]
    }

    fn values(&self, context: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        vec![
            -amplitudes[0] / self.quantum(context),
            instant(context, shape),
        ]
    }

    fn amplitudes(&self, context: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (
            vec![-values[0] * self.quantum(context)],
            row_at(context, values[1]),
        )
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
