//! Effects on torques of the drives and on the force sensor (docs/diagnosis-force.md): torques alone show them.

pub(crate) mod bias;
pub(crate) mod crosstalk;
pub(crate) mod gain;
mod grip_force;
pub(crate) mod hysteresis;
pub(crate) mod joint_friction;
pub(crate) mod motor_cogging;
pub(crate) mod sliding_friction;
pub(crate) mod torque_gain;
mod unbalanced_gravity;
pub(crate) mod warming;

pub use bias::SPEC as BIAS;
pub use crosstalk::SPEC as CROSSTALK;
pub use gain::SPEC as GAIN;
pub use grip_force::SPEC as GRIP_FORCE;
pub use hysteresis::SPEC as HYSTERESIS;
pub use joint_friction::SPEC as JOINT_FRICTION;
pub use motor_cogging::{COGGING_ORDERS, SPEC as MOTOR_COGGING};
pub use sliding_friction::SPEC as SLIDING_FRICTION;
pub use torque_gain::SPEC as TORQUE_GAIN;
pub use unbalanced_gravity::SPEC as UNBALANCED_GRAVITY;
pub use warming::SPEC as WARMING;
