//! A constant, or one that grows with temperature, in what the force sensor reads.

use crate::{Family, Follows, Hook, Need, Parameter, Spec, Unit};

/// A constant, or one that grows with temperature, in what the force sensor reads.
pub const SPEC: Spec = Spec {
    name: "force-bias",
    meaning: "the force sensor reads a force without one",
    inspect: "its zero, and its temperature",
    adds: "J^T b, J^T b_T dT",
    source: "E1",
    hook: Hook::ForceSensor,
    family: Family::Stated,
    needs: &[Need::Time, Need::Torque, Need::Force],
    parameters: &[
        Parameter::size("x_n", Unit::Newton, 0.0, 5.0),
        Parameter::size("y_n", Unit::Newton, 0.0, 5.0),
        Parameter::size("z_n", Unit::Newton, 0.0, 5.0),
        Parameter::size("x_n_per_k", Unit::NewtonPerKelvin, 0.0, f64::MAX),
        Parameter::size("y_n_per_k", Unit::NewtonPerKelvin, 0.0, f64::MAX),
        Parameter::size("z_n_per_k", Unit::NewtonPerKelvin, 0.0, f64::MAX),
    ],
    follows: Follows::Temperature,
    ..Spec::COMMON
};
