//! Effects on torques and forces. What they are; their laws are evaluated by the diagnosis of torques (docs/diagnosis-force.md).

mod bias;
mod crosstalk;
mod gain;
mod grip_force;
mod hysteresis;
mod joint_friction;
mod motor_cogging;
mod torque_gain;
mod unbalanced_gravity;

pub use bias::SPEC as BIAS;
pub use crosstalk::SPEC as CROSSTALK;
pub use gain::SPEC as GAIN;
pub use grip_force::SPEC as GRIP_FORCE;
pub use hysteresis::SPEC as HYSTERESIS;
pub use joint_friction::SPEC as JOINT_FRICTION;
pub use motor_cogging::SPEC as MOTOR_COGGING;
pub use torque_gain::SPEC as TORQUE_GAIN;
pub use unbalanced_gravity::SPEC as UNBALANCED_GRAVITY;
