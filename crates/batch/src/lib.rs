//! Distances of many poses at once: residuals and all derivatives.
//!
#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod error;
mod model;
mod pose_lanes;
mod poses;
mod program;
mod rows;
mod screws;
mod sweep;
mod trigonometry;

pub use error::BatchError;
pub use model::DistanceModel;
pub use pose_lanes::PoseLanes;
pub use poses::PoseBatch;
pub use rows::TileRows;
pub use screws::{Lane, POSTURES, ScrewTile, TwistLanes};
pub use trigonometry::sines_cosines;
