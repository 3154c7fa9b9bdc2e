//! The zero of the cable encoder drifts in time.

use crate::laws::{COURSES, Drift};
use crate::{Family, Hook, LawError, Need, Parameter, Shape, Spec, Unit};

/// The cable encoder's zero drifts with time.
pub const SPEC: Spec = Spec {
    name: "cable-drift",
    meaning: "the cable encoder's zero drifts with time",
    inspect: "warm-up of the encoder, and creep of the cable",
    adds: "c t",
    source: "C10",
    hook: Hook::CableSensor,
    family: Family::Drift,
    needs: &[Need::Time, Need::Cable],
    parameters: &[Parameter::size("m_per_s", Unit::MetrePerSecond, 0.0, 1e-4)],
    shape: Shape::Listed(&COURSES),
    law_error: LawError::DRIFT,
    ..Spec::COMMON
};

pub(crate) const LAW: Drift = Drift;

#[cfg(test)]
crate::conforms!(SPEC);
