//! The cable of a capstan stretches: in front of its external encoder the joint stays behind by torque over
//! stiffness.

use crate::laws::Spring;
use crate::transmission::HOLD_THE_MOTOR;
use crate::{Hook, Need, Spec};

/// The capstan's cable stretches with the torque.
pub const SPEC: Spec = Spec {
    name: "capstan-compliance",
    meaning: "the capstan's cable stretches with the torque",
    inspect: "the pre-tension, diameter and free length of that cable",
    confirm: HOLD_THE_MOTOR,
    adds: "-tau / k",
    source: "A1",
    hook: Hook::Transmission,
    needs: &[Need::Torque, Need::Output],
    ..Spring::SPEC
};

pub(crate) const LAW: Spring = Spring;
