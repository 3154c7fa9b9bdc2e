//! Robot descriptions in XML: a device from a chain of a URDF or an MJCF, and URDF or MJCF from a device.
//!
#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod chain;
mod device;
mod error;
mod numbers;
mod rigid;
mod robot;
mod words;
mod write;

pub use chain::ends::{ChainEnd, chain_ends};
pub use chain::path::BaseAndTip;
pub use device::{UrdfDevice, device_from_mjcf, device_from_urdf, read_urdf_text};
pub use error::UrdfError;
pub use write::added_joints::NewJoints;
pub use write::corrected::{CorrectedUrdf, corrected_urdf};
pub use write::effects::AHEAD as ENCODERS_AHEAD;
pub use write::kinematics_yaml::kinematics_yaml;
pub use write::loaders::{Loader, loader_notes};
pub use write::mjcf::new_mjcf;
pub use write::origins::{JointOrigin, UrdfOrigins};
pub use write::patched::{CorrectedMjcf, corrected_mjcf};
pub use write::ros2_control::ros2_control;
pub use write::urdf::{new_urdf, new_urdf_for};
