//! The zero of a drive drifts in time, steadily or until it settles.

use crate::laws::{COURSES, Drift};
use crate::{Family, Hook, LawError, Need, Parameter, Shape, Spec, Unit};

/// The joint's zero drifts with time or temperature.
pub const SPEC: Spec = Spec {
    name: "joint-drift",
    meaning: "the joint's zero drifts with time or temperature",
    inspect: "warm-up, and the cable's tension before and after",
    adds: "c t",
    hook: Hook::Transmission,
    family: Family::Drift,
    needs: &[Need::Time],
    parameters: &[Parameter::size(
        "rad_per_s",
        Unit::RadianPerSecond,
        0.0,
        5e-4,
    )],
    shape: Shape::Listed(&COURSES),
    look_alikes: &["capstan-creep"],
    law_error: LawError::DRIFT,
    ..Spec::COMMON
};

pub(crate) const LAW: Drift = Drift;

#[cfg(test)]
crate::conforms!(SPEC);
