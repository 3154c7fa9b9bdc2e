//! The scale of a drive's torque.

use crate::{Family, Follows, Hook, Need, Parameter, Spec, Unit};

/// The scale of a drive's torque.
pub const SPEC: Spec = Spec {
    name: "torque-gain",
    meaning: "the torque's scale is not the stated one",
    inspect: "the motor's constant and the amplifier's gain",
    adds: "s tau",
    source: "E8",
    hook: Hook::Torque,
    family: Family::Stated,
    needs: &[Need::Time, Need::Torque],
    parameters: &[Parameter::size("gain", Unit::One, 0.0, 1.0)],
    follows: Follows::Torque,
    ..Spec::COMMON
};
