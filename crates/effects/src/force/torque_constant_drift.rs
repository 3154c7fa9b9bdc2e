//! A torque constant that changes over a log.

use crate::{Family, Hook, Need, Parameter, Spec};

/// Magnets grow weaker as they warm: the torque constant changes with time or with the temperature.
pub const SPEC: Spec = Spec {
    name: "torque-constant-drift",
    meaning: "a motor's torque constant changes with time or temperature",
    inspect: "the temperature of the motor's magnets, and the gain of its current sensor",
    adds: "k_t a (t - t_0) i",
    hook: Hook::Torque,
    family: Family::Drift,
    needs: &[Need::Time, Need::Torque, Need::Current],
    parameters: &[
        Parameter::size("share_per_s", 0.0, f64::MAX),
        Parameter::size("share_per_degc", 0.0, f64::MAX),
    ],
    ..Spec::COMMON
};
