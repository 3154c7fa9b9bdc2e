//! The wrap slips once, under load.

use crate::context::Context;
use crate::laws::{instant, row_at, step};
use crate::{Effect, Family, Hook, LawError, Need, Parameter, Shape, Signal, Spec, Unit};

/// The cable slipped on the drum at one moment.
pub const SPEC: Spec = Spec {
    name: "capstan-slip",
    meaning: "the cable slipped on the drum at one moment",
    inspect: "the number of turns on the drum and the torque at that time",
    adds: "step",
    source: "A3",
    hook: Hook::Transmission,
    family: Family::Step,
    needs: &[Need::Time, Need::Motion, Need::Torque],
    parameters: &[
        Parameter::size("slip_rad", Unit::Radian, 0.0, 0.1),
        Parameter::instant(),
    ],
    shape: Shape::Event,
    under_load: true,
    log_prior: -3.0,
    law_error: LawError::STEP,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct CapstanSlip {
    pub(crate) joint: usize,
}

impl Effect for CapstanSlip {
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
        vec![amplitudes[0], instant(context, shape)]
    }

    fn amplitudes(&self, context: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![values[0]], row_at(context, values[1]))
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
