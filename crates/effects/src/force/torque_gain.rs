//! The scale of a drive's torque.

use crate::laws::Linear;
use crate::{Absorbed, Follows, Form, Hook, Need, Parameter, Spec};

/// The scale of a drive's torque.
pub const SPEC: Spec = Spec {
    name: "torque-gain",
    meaning: "the torque's scale is not the stated one",
    inspect: "the motor's constant and the amplifier's gain",
    adds: "s tau",
    source: "E8",
    hook: Hook::Torque,
    form: Form::Scale,
    needs: &[Need::Time, Need::Torque],
    parameters: &[Parameter::size("gain", 0.0, 1.0)],
    follows: Follows::Torque,
    absorbed_by: Absorbed::ByTorqueScale,
    ..Spec::COMMON
};

pub(crate) const LAW: Linear = Linear(|input| Some(vec![input.torque_nm()?.to_vec()]));
