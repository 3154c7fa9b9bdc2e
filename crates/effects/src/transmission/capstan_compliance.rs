//! The cable of a capstan stretches: in front of its external encoder the joint stays behind by torque over
//! stiffness.

use crate::laws::Spring;
use crate::{Hook, Need, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "capstan-compliance",
    meaning: "the capstan's cable stretches with the torque",
    inspect: "the pre-tension, diameter and free length of that cable",
    adds: "-tau / k",
    source: "A1",
    hook: Hook::Transmission,
    needs: &[Need::Torque, Need::Output],
    ..Spring::SPEC
};

pub(crate) const LAW: Spring = Spring;
