//! An external encoder loses counts.

use haptical_model::Joint;
use std::f64::consts::TAU;

use crate::laws::{Input, Step};
use crate::{Hook, LogFault, Need, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "external-encoder-count-loss",
    meaning: "an external encoder lost counts or slipped at one moment",
    inspect: "its clamp, plug and supply",
    adds: "steps",
    source: "B3",
    hook: Hook::ExternalEncoder,
    needs: &[Need::Time, Need::Motion, Need::Output],
    log_fault: Some(LogFault::Step),
    ..Step::SPEC
};

pub(crate) const LAW: Step = Step {
    unit,
    is_of_reading: false,
};

/// Size of one count; three standard deviations (the paper's rule) where the device file has no counts.
fn unit(input: Input<'_, '_>) -> f64 {
    let by_counts = |joint: &Joint| Some(TAU / joint.external_encoder_counts_per_rev?);
    let by_noise = |joint: &Joint| Some(3.0 * joint.output_sd_rad()?);
    let joint = input.joint();
    let size = joint.and_then(|joint| by_counts(joint).or_else(|| by_noise(joint)));
    size.unwrap_or(1.0)
}
