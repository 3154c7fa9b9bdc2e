//! A joint or link yields behind the external encoder by torque over stiffness.

use crate::laws::Spring;
use crate::{Absorbed, Hook, Need, Spec};

/// A joint or link bends with its torque, behind the external encoder.
pub const SPEC: Spec = Spec {
    name: "joint-compliance",
    meaning: "a joint or link bends with its torque, behind the external encoder",
    inspect: "bearings, clamps and the link's stiffness",
    adds: "-tau / k",
    source: "D1, D2",
    hook: Hook::Joint,
    needs: &[Need::Torque, Need::Chain],
    absorbed_by: Absorbed::ByCompliance,
    ..Spring::SPEC
};

pub(crate) const LAW: Spring = Spring;
