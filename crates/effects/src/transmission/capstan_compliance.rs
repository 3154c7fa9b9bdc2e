//! The cable of a capstan stretches: in front of its external encoder the joint stays behind by torque over
//! stiffness.

use crate::laws::Spring;
use crate::{Family, Follows, Hook, LawError, Need, Parameter, Spec, Unit};

/// The capstan's cable stretches with the torque.
pub const SPEC: Spec = Spec {
    name: "capstan-compliance",
    meaning: "the capstan's cable stretches with the torque",
    inspect: "the pre-tension, diameter and free length of that cable",
    adds: "-tau / k",
    source: "A1",
    hook: Hook::Transmission,
    family: Family::Load,
    needs: &[Need::Torque, Need::Output],
    parameters: &[Parameter::inverse(
        "stiffness_nm_per_rad",
        Unit::NewtonMetrePerRadian,
        20.0,
        1e7,
    )],
    follows: Follows::Torque,
    is_positive: true,
    scales_with_torque: true,
    law_error: LawError::LOAD,
    ..Spec::COMMON
};

pub(crate) const LAW: Spring = Spring;

#[cfg(test)]
crate::conforms!(SPEC);
