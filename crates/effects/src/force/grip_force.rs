//! A force of the hand beside the force sensor.

use crate::{Family, Follows, Hook, Need, Parameter, Spec, Unit};

/// A force of the hand beside the force sensor.
pub const SPEC: Spec = Spec {
    name: "grip-force",
    meaning: "the hand loads the handle beside what the force sensor sees",
    inspect: "how the handle is held while recording",
    adds: "a free force per block",
    source: "E10",
    hook: Hook::Torque,
    family: Family::Load,
    needs: &[Need::Time, Need::Torque, Need::Force],
    parameters: &[Parameter::size("rms_n", Unit::Newton, 0.0, 30.0)],
    follows: Follows::Time,
    ..Spec::COMMON
};
