//! A motor encoder loses counts: by these its reading is too high afterwards, and the measured channels, which are
//! compared with it, are too low.

use haptical_model::Joint;

use crate::laws::{Input, Step};
use crate::{Hook, LogFault, Need, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "encoder-count-loss",
    meaning: "a motor encoder lost counts at one moment",
    inspect: "plug, shield and supply of that encoder, and its counter's input filter",
    adds: "steps",
    source: "A9",
    hook: Hook::Transmission,
    needs: &[Need::Time, Need::Motion, Need::Counts],
    log_fault: Some(LogFault::Step),
    ..Step::SPEC
};

pub(crate) const LAW: Step = Step {
    unit,
    is_of_reading: true,
};

/// Size of one count \[rad\], or \[m\] of a slide; 1 where the device file has none. Counts too many turn the joint back.
fn unit(input: Input<'_, '_>) -> f64 {
    let quantum = input.joint().and_then(Joint::reading_quantum_rad);
    -quantum.unwrap_or(1.0)
}
