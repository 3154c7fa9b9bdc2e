//! Devices with cable drives: their files, parameters by name, and predictions with derivatives.
//!
#![doc = include_str!("../README.md")]

mod device;
mod device_file;
mod device_writer;
mod error;
mod evaluation;
mod force;
mod joint;
mod joint_file;
mod parameters;
mod reader;
mod recording;
mod sensor_file;
mod toml_file;
mod toml_syntax;

pub use device::{Body, Cable, ContactPair, Device, Tracker};
pub use device_file::LoadedDevice;
pub use error::{DeviceFileError, ModelError, Position};
pub use evaluation::Evaluation;
pub use force::{ForceTransmission, handle_force_n};
pub use haptical_kinematics as kinematics;
pub use haptical_transmission as transmission;
pub use joint::{Joint, JointType, TransmissionError, TransmissionKind};
pub use parameters::{LinkParameter, ParameterId};
pub use recording::Recording;
pub use toml_file::read_toml_text;
pub use toml_syntax::check_toml_syntax;
