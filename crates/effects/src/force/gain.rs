//! Scales of the force sensor's axes.

use crate::{Family, Follows, Hook, Need, Parameter, Spec, Unit};

/// Scales of the force sensor's axes.
pub const SPEC: Spec = Spec {
    name: "force-gain",
    meaning: "the force sensor's scale is not the stated one",
    inspect: "its calibration with a weight",
    adds: "J^T diag(F)",
    source: "E2",
    hook: Hook::ForceSensor,
    family: Family::Stated,
    needs: &[Need::Time, Need::Torque, Need::Force],
    parameters: &[
        Parameter::size("x", Unit::One, 0.0, 0.2),
        Parameter::size("y", Unit::One, 0.0, 0.2),
        Parameter::size("z", Unit::One, 0.0, 0.2),
    ],
    follows: Follows::Force,
    ..Spec::COMMON
};
