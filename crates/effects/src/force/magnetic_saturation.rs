//! A torque constant that falls with the current.

use crate::{Family, Follows, Hook, Need, Parameter, Spec};

/// The iron of a motor saturates: its torque constant falls in proportion to the current.
pub const SPEC: Spec = Spec {
    name: "magnetic-saturation",
    meaning: "a motor's torque constant falls with its current",
    inspect: "the largest current against the motor's data sheet, and the current sensor's range",
    adds: "-k_t s |i| i",
    hook: Hook::Torque,
    family: Family::Load,
    needs: &[Need::Time, Need::Torque, Need::Current],
    parameters: &[Parameter::size("share_per_a", 0.0, f64::MAX)],
    follows: Follows::Torque,
    ..Spec::COMMON
};
