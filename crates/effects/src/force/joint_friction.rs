//! Friction that a drive overcomes: Coulomb's, viscous, and Stribeck's at low rates.

use crate::{Family, Follows, Hook, Need, Parameter, Spec, Unit};

/// Friction that a drive overcomes: Coulomb's, viscous, and Stribeck's at low rates.
pub const SPEC: Spec = Spec {
    name: "joint-friction",
    meaning: "a joint's friction is missing in the torque",
    inspect: "bearings and cable of the joint",
    adds: "h or tanh(omega / v), omega, h exp(-(omega / 0.1)^2)",
    source: "E6",
    hook: Hook::Torque,
    family: Family::Loop,
    needs: &[Need::Time, Need::Torque],
    parameters: &[
        Parameter::size("coulomb_nm", Unit::NewtonMetre, 0.0, 0.3).times_ratio(),
        Parameter::size(
            "viscous_nm_s_per_rad",
            Unit::NewtonMetreSecondPerRadian,
            0.0,
            f64::MAX,
        ),
        Parameter::size("stribeck_nm", Unit::NewtonMetre, 0.0, f64::MAX),
        Parameter::transition("transition_rad", Unit::Radian, f64::MAX),
        Parameter::transition("transition_rad_per_s", Unit::RadianPerSecond, f64::MAX),
    ],
    follows: Follows::Speed,
    ..Spec::COMMON
};
