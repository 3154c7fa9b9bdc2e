//! The zero of an external encoder drifts in time.

use crate::laws::{COURSES, Drift};
use crate::{Family, Hook, LawError, Need, Parameter, Shape, Spec, Unit};

/// The zero of an external encoder drifts.
pub const SPEC: Spec = Spec {
    name: "external-encoder-drift",
    meaning: "the zero of an external encoder drifts",
    inspect: "its clamp, and its temperature",
    adds: "c t",
    source: "B4",
    hook: Hook::ExternalEncoder,
    family: Family::Drift,
    needs: &[Need::Time, Need::Output],
    parameters: &[Parameter::size(
        "rad_per_s",
        Unit::RadianPerSecond,
        0.0,
        5e-4,
    )],
    shape: Shape::Listed(&COURSES),
    law_error: LawError::DRIFT,
    ..Spec::COMMON
};

pub(crate) const LAW: Drift = Drift;

#[cfg(test)]
crate::conforms!(SPEC);
