//! The cable encoder loses counts.

use std::f64::consts::TAU;

use crate::laws::{Input, Step};
use crate::{Hook, LogFault, Need, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "cable-count-loss",
    meaning: "the cable encoder lost counts at one moment",
    inspect: "its plug and supply, and the speed of the cable",
    adds: "steps",
    source: "C12",
    hook: Hook::CableSensor,
    needs: &[Need::Time, Need::Motion, Need::Cable],
    log_fault: Some(LogFault::Step),
    ..Step::SPEC
};

pub(crate) const LAW: Step = Step {
    unit,
    is_of_reading: false,
};

/// Size of one count \[m\]; three standard deviations (the paper's rule) where the device file has no counts.
fn unit(input: Input<'_, '_>) -> f64 {
    let device = input.context.device;
    let cable = device.cables.first();
    let by_counts =
        cable.and_then(|cable| Some(TAU * cable.drum_radius_m? / cable.counts_per_rev?));
    let by_noise = || device.cable_sd_m(0).map(|sd| 3.0 * sd);
    by_counts.or_else(by_noise).unwrap_or(1.0)
}
