//! The calibrated model of a device for a control loop: readings in, angles, pose, Jacobian, torques out.
//!
#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]

mod capstan;
mod coupled;
mod device;
mod error;
mod general_row;
mod model;
mod parallelogram;
mod polynomial;
mod state;
mod transform;
mod transmission;
mod trigonometry;

pub use capstan::Capstan;
pub use coupled::{CoupledModel, RowDrive};
pub use device::{Convention, Joint, Motion, Row};
pub use error::{DeviceError, RuntimeError};
pub use general_row::{Frame, GeneralRow};
pub use model::Model;
pub use parallelogram::Parallelogram;
pub use polynomial::{POLYNOMIAL_TERMS, padded};
pub use state::{State, Twist};
pub use transmission::Transmission;
pub use trigonometry::{LARGEST_ANGLE_RAD, arctangent2, sine_cosine};
