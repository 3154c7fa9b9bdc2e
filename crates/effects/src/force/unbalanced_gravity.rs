//! A mass or its centre that is not where the device file assumes it.

use crate::{Family, Follows, Hook, Need, Parameter, Spec};

/// A mass or its centre that is not where the device file assumes it.
pub const SPEC: Spec = Spec {
    name: "unbalanced-gravity",
    meaning: "a weight is not balanced as the device file says",
    inspect: "counterweights and masses of the device file",
    adds: "another mass and centre of a link",
    source: "E9",
    hook: Hook::Torque,
    family: Family::Load,
    needs: &[Need::Time, Need::Torque, Need::Gravity],
    parameters: &[
        Parameter::size("moment_nm", 0.0, f64::MAX),
        Parameter::size("deviations", 0.0, f64::MAX),
        Parameter::size("mass_kg", 0.0, f64::MAX),
    ],
    follows: Follows::Angle,
    ..Spec::COMMON
};
