//! Torques of a moving arm: a base model of rigid bodies, friction and delay, and the effects that it lacks.
//!
#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod arm;
mod base;
mod between;
mod column;
mod effect;
mod error;
mod examine;
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

pub use between::{Between, LoadSource, OwnEffect, examine_between, examine_own};
pub use effect::effect_names;
pub use error::MotionError;
pub use examine::{ChannelFit, Examined, Finding, NearRival, examine, is_moving_arm};
pub use loads::link_torques;
pub use unseen::{PARTS, Unseen};
