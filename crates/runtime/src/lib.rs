//! The calibrated model of a device for a control loop: readings in, angles, pose, Jacobian, torques out.
//!
#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]

mod capstan;
mod compensated;
mod coupled;
mod device;
mod error;
mod limits;
mod model;
mod parallelogram;
mod state;
mod transmission;

pub use capstan::Capstan;
pub use compensated::{
    CompensatedModel, CompensatedState, Effect, EffectState, Inputs, Over, Side, Turnover,
};
pub use coupled::{CoupledModel, RowDrive};
pub use device::{GeneralRow, Joint, Motion};
pub use error::{DeviceError, RuntimeError};
pub use haptical_kinematics::{Convention, Link, Pose, Twist};
pub use model::Model;
pub use parallelogram::Parallelogram;
pub use state::State;
pub use transmission::{POLYNOMIAL_TERMS, Transmission, padded};
