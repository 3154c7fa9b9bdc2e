//! Torques of a moving arm: a base model of rigid bodies, friction and delay, and the effects that it lacks.
//!
#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod adjusted;
mod arm;
mod between;
mod change;
mod dependence;
mod effect;
mod error;
mod examine;
mod examined;
mod findings;
mod fit;
mod identify;
mod later;
mod loads;
mod partial;
mod recorded;
mod scale;
mod select;
mod signal;
mod survey;
mod thresholds;
mod tracking;
mod unseen;
mod without_gravity;
mod zeros;

pub use adjusted::Adjusted;
pub use between::{Between, LoadSource, OwnEffect, examine_between, examine_own};
pub use change::Change;
pub use dependence::{Dependence, Quantity};
pub use effect::effect_names;
pub use error::MotionError;
pub use examine::{examine, is_moving_arm};
pub use examined::{ChannelFit, Examined, Finding, NearRival};
pub use identify::{
    BaseParameter, BodyDynamics, Dynamics, Estimated, FrictionLaw, Instruments, JointDynamics,
    NOISE_SEED, Residual, compared_dynamics, identify_drives, identify_dynamics, stacked_percent,
    torques_left, with_dynamics,
};
pub use loads::link_torques;
pub use recorded::torque_nm_without_effects;
pub use scale::{Doubt, Scale};
pub use signal::line::Line;
pub use signal::noise::Noise;
pub use survey::{
    Survey, SurveyedJoint, SurveyedTorque, is_fast_enough, survey, unwrapped, usual_step_s, why_not,
};
pub use thresholds::TEXTS as THRESHOLDS;
pub use thresholds::examine::{OF_SECOND_BESIDE_SPRING, PARTS};
pub use tracking::{Tracking, Untracked, examine_tracking};
pub use unseen::Unseen;
