//! Devices with cable drives: their files, parameters by name, and predictions with derivatives.
//!
#![doc = include_str!("../README.md")]

pub mod cholesky;
mod device;
mod error;
mod evaluation;
mod file;
mod force;
mod holding;
mod inverse;
mod parameter;
mod recording;
pub mod rigid;
mod rigid_bodies;
pub mod sizes;
mod statics;

pub use device::cable::{Cable, CableFit, CableReading};
pub use device::chain::DeviceChain;
pub use device::drive::{
    DriveNumber, FrictionNumber, JOINT_FRICTION, SizedEffect, drive_numbers_in_words,
};
pub use device::effect::{DeviceEffect, FitNumber};
pub use device::joint::{Joint, JointType, TransmissionError, TransmissionKind};
pub use device::mount::{Mount, RunBase, Tool, Unplaced};
pub use device::rows::{Drive, Origin};
pub use device::surroundings::{
    ContactPoint, JointCompliance, Placement, PlanePair, Surroundings, TouchedPlane,
};
pub use device::tree::Hand;
pub use device::{Body, ContactPair, Device, Tracker};
pub use error::{DeviceFileError, ModelError, Position};
pub use evaluation::Evaluation;
pub use file::device::LoadedDevice;
pub use file::effect::stiffness_key;
pub use file::syntax::check_toml_syntax;
pub use file::text::{read_text_file, read_toml_text};
pub use force::{ForceTransmission, TrueSide, handle_force_n};
pub use haptical_dynamics as dynamics;
pub use haptical_kinematics as kinematics;
pub use haptical_kinematics::Parameter;
pub use haptical_transmission as transmission;
pub use holding::holding_torques_nm;
pub use inverse::{InversePose, Reached, Wanted};
pub use parameter::ParameterId;
pub use parameter::surrounding::{LengthScale, SurroundingParameter, UNSTATED_SCALE_SD};
pub use parameter::unknown::UnknownNumbers;
pub use recording::joined::NotJoined;
pub use recording::{AddedBy, AddedReadings, Recording, varies};
pub use rigid_bodies::{
    Flange, GivenInertia, Missing, MotionWork, RigidBodies, RowBody, RowMass, Segment, SegmentBody,
    Segments,
};
pub use statics::{Beyond, Load, Statics, Weight};
