//! Effects on torques of the drives and on the force sensor (docs/diagnosis-force.md): torques alone show them.

use crate::{Follows, Hook, Need, Spec};

pub(crate) mod bias;
pub(crate) mod crosstalk;
pub(crate) mod gain;
mod grip_force;
pub(crate) mod hysteresis;
pub mod in_motion;
pub(crate) mod joint_friction;
mod magnetic_saturation;
pub(crate) mod motor_cogging;
pub(crate) mod payload;
mod torque_constant_drift;
pub(crate) mod torque_gain;
mod unbalanced_gravity;

pub use grip_force::SPEC as GRIP_FORCE;
pub use joint_friction::SPEC as JOINT_FRICTION;
pub use magnetic_saturation::SPEC as MAGNETIC_SATURATION;
pub use motor_cogging::COGGING_ORDERS;
pub use payload::{ON_LINK as PAYLOAD_ON_LINK, SPEC as PAYLOAD};
pub use torque_constant_drift::SPEC as TORQUE_CONSTANT_DRIFT;
pub use torque_gain::SPEC as TORQUE_GAIN;
pub use unbalanced_gravity::SPEC as UNBALANCED_GRAVITY;

/// What the effects of the force sensor have in common.
const SENSOR: Spec = Spec {
    hook: Hook::ForceSensor,
    needs: &[Need::Time, Need::Torque, Need::Force],
    follows: Follows::Force,
    ..Spec::COMMON
};
