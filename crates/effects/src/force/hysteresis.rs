//! Each axis of the force sensor lags in a loop, Dahl's state of the force.

use crate::{Family, Follows, Hook, Need, Parameter, Spec, Unit};

/// Each axis of the force sensor lags in a loop, Dahl's state of the force.
pub const SPEC: Spec = Spec {
    name: "force-hysteresis",
    meaning: "the force sensor reads differently while loading and unloading",
    inspect: "its mounting and overload",
    adds: "J^T h(F), Dahl's state per axis",
    source: "E4",
    hook: Hook::ForceSensor,
    family: Family::Loop,
    needs: &[Need::Time, Need::Torque, Need::Force],
    parameters: &[
        Parameter::size("x_n", Unit::Newton, 0.0, 2.0),
        Parameter::size("y_n", Unit::Newton, 0.0, 2.0),
        Parameter::size("z_n", Unit::Newton, 0.0, 2.0),
        Parameter::transition("transition_n", Unit::Newton, f64::MAX),
    ],
    follows: Follows::Force,
    ..Spec::COMMON
};
