//! A force of the hand that the force sensor does not see.

use crate::{Family, Hook, Need, Parameter, Spec};

/// A force of the hand that the force sensor does not see.
pub const SPEC: Spec = Spec {
    name: "grip-force",
    meaning: "the hand loads the handle beside what the force sensor sees",
    inspect: "how the handle is held while recording",
    adds: "a free force per block",
    source: "E10",
    hook: Hook::Torque,
    family: Family::Load,
    needs: &[Need::Time, Need::Torque, Need::Force],
    parameters: &[Parameter::size("rms_n", 0.0, 30.0)],
    ..Spec::COMMON
};
