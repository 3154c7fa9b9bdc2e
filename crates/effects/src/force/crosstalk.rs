//! One axis of the force sensor reads part of the force along another.

use crate::{Family, Follows, Hook, Need, Parameter, Spec, Unit};

/// One axis of the force sensor reads part of the force along another.
pub const SPEC: Spec = Spec {
    name: "force-crosstalk",
    meaning: "a force along one axis shows on another",
    inspect: "how the force sensor is turned on the handle",
    adds: "J^T X F, X without diagonal",
    source: "E3",
    hook: Hook::ForceSensor,
    family: Family::Stated,
    needs: &[Need::Time, Need::Torque, Need::Force],
    parameters: &[
        Parameter::size("xy", Unit::One, 0.0, 0.2),
        Parameter::size("xz", Unit::One, 0.0, 0.2),
        Parameter::size("yx", Unit::One, 0.0, 0.2),
        Parameter::size("yz", Unit::One, 0.0, 0.2),
        Parameter::size("zx", Unit::One, 0.0, 0.2),
        Parameter::size("zy", Unit::One, 0.0, 0.2),
    ],
    follows: Follows::Force,
    ..Spec::COMMON
};
