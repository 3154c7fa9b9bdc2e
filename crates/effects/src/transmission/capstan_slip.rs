//! The wrap slips once, under load.

use crate::laws::Step;
use crate::{Family, Hook, LawError, Need, Parameter, Shape, Spec, Unit};

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

pub(crate) const LAW: Step = Step { unit: |_| 1.0 };

#[cfg(test)]
crate::conforms!(SPEC);
