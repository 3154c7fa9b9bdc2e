//! Devices with cable drives: their files, parameters by name, and predictions with derivatives.
//!
#![doc = include_str!("../README.md")]

mod cable;
mod deviations;
mod device;
mod device_chain;
mod device_file;
mod device_text;
mod device_writer;
mod error;
mod evaluation;
mod force;
mod holding;
mod joint;
mod joint_file;
mod parameters;
mod reader;
mod recording;
mod rig;
mod row_file;
mod rows;
mod sensor_file;
mod surrounding_file;
mod surrounding_parameter;
mod surrounding_text;
mod surroundings;
mod toml_file;
mod toml_syntax;

pub use cable::{Cable, CableFit, CableReading};
pub use deviations::UnknownNumbers;
pub use device::{Body, ContactPair, Device, Tracker};
pub use device_chain::DeviceChain;
pub use device_file::LoadedDevice;
pub use error::{DeviceFileError, ModelError, Position};
pub use evaluation::Evaluation;
pub use force::{ForceTransmission, handle_force_n};
pub use haptical_kinematics as kinematics;
pub use haptical_transmission as transmission;
pub use holding::{Load, Statics, holding_torques_nm};
pub use joint::{Joint, JointType, TransmissionError, TransmissionKind};
pub use parameters::{LinkParameter, ParameterId};
pub use recording::Recording;
pub use rows::{Drive, Origin};
pub use surrounding_parameter::SurroundingParameter;
pub use surroundings::{
    ContactPoint, JointCompliance, Placement, PlanePair, Surroundings, TouchedPlane,
};
pub use toml_file::{read_text_file, read_toml_text};
pub use toml_syntax::check_toml_syntax;
