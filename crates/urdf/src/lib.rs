//! Robot descriptions in XML: a device from a chain of a URDF, and URDF or MJCF from a device.
//!
#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod beside;
mod chain;
mod correct;
mod device;
mod ends;
mod error;
mod gaps;
mod mjcf;
mod new_urdf;
mod numbers;
mod parse;
mod path;
mod rigid;
mod robot;
mod segments;
mod tip;
mod weight;

pub use correct::{CorrectedUrdf, corrected_urdf};
pub use device::{UrdfDevice, device_from_urdf, read_urdf_text};
pub use ends::{ChainEnd, chain_ends};
pub use error::UrdfError;
pub use mjcf::new_mjcf;
pub use new_urdf::new_urdf;
pub use path::BaseAndTip;
