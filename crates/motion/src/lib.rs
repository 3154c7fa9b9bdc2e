//! Torques of a moving arm: a base model of rigid bodies, friction and delay, and the effects that it lacks.
//!
#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod arm;
mod base;
mod column;
mod dependence;
mod effect;
mod error;
mod examine;
mod identify;
mod loads;
mod local_polynomial;
mod low_pass;
mod noise;
mod plausible;
mod problem;
mod samples;
mod sampling;
mod select;
mod states;
mod system;
mod trimmed;
mod unseen;

pub use dependence::{Dependence, Quantity};
pub use effect::effect_names;
pub use error::MotionError;
pub use examine::{ChannelFit, Examined, Finding, NearRival, examine, is_moving_arm};
pub use identify::{
    BaseParameter, BodyDynamics, Dynamics, Estimated, FrictionLaw, Instruments, JointDynamics,
    NOISE_SEED, Residual, identify_dynamics, stacked_percent, with_dynamics,
};
pub use loads::link_torques;
pub use unseen::{PARTS, Unseen};
