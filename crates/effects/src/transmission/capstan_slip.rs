//! The wrap slips once, under load.

use crate::laws::Step;
use crate::{Hook, Need, Parameter, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "capstan-slip",
    meaning: "the cable slipped on the drum at one moment",
    inspect: "the number of turns on the drum and the torque at that time",
    adds: "step",
    source: "A3",
    hook: Hook::Transmission,
    needs: &[Need::Time, Need::Motion, Need::Torque],
    parameters: &[Parameter::size("slip_rad", 0.0, 0.1), Parameter::instant()],
    under_load: true,
    log_prior: -3.0,
    ..Step::SPEC
};

pub(crate) const LAW: Step = Step {
    unit: |_| 1.0,
    is_of_reading: false,
};
