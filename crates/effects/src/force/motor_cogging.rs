//! A torque at a multiple of the motor's angle.

use crate::{Family, Follows, Hook, Need, Parameter, Spec, Unit};

/// A torque at a multiple of the motor's angle.
pub const SPEC: Spec = Spec {
    name: "motor-cogging",
    meaning: "the motor's torque ripples as it turns",
    inspect: "the motor and its commutation",
    adds: "A cos(n R theta - phase)",
    source: "E7",
    hook: Hook::Torque,
    family: Family::Shape,
    needs: &[Need::Time, Need::Torque],
    parameters: &[
        Parameter::size("amplitude_nm", Unit::NewtonMetre, 0.0, 0.3).times_ratio(),
        Parameter::phase(),
        Parameter::number("order", f64::MAX),
    ],
    follows: Follows::Angle,
    ..Spec::COMMON
};
