//! A joint or link yields behind the external encoder by torque over stiffness.

use crate::laws::Spring;
use crate::{Absorbed, Family, Follows, Hook, LawError, Need, Parameter, Spec, Unit};

/// A joint or link bends with its torque, behind the external encoder.
pub const SPEC: Spec = Spec {
    name: "joint-compliance",
    meaning: "a joint or link bends with its torque, behind the external encoder",
    inspect: "bearings, clamps and the link's stiffness",
    adds: "-tau / k",
    source: "D1, D2",
    hook: Hook::Joint,
    family: Family::Load,
    needs: &[Need::Torque, Need::Chain],
    parameters: &[Parameter::inverse(
        "stiffness_nm_per_rad",
        Unit::NewtonMetrePerRadian,
        20.0,
        1e7,
    )],
    follows: Follows::Torque,
    is_positive: true,
    scales_with_torque: true,
    absorbed_by: Absorbed::ByCompliance,
    law_error: LawError::LOAD,
    ..Spec::COMMON
};

pub(crate) const LAW: Spring = Spring;

#[cfg(test)]
crate::conforms!(SPEC);
