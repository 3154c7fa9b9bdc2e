//! Distances of many poses at once: residuals, all derivatives, and their reduction to a triangle.
//!
#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod blocks;
mod error;
mod model;
mod pose_lanes;
mod poses;
mod problem;
mod program;
mod solve;
mod sweep;
mod trigonometry;

pub use blocks::Threads;
pub use error::BatchError;
pub use haptical_linalg::Triangle;
pub use model::DistanceModel;
pub use pose_lanes::PoseLanes;
pub use poses::{PoseBatch, Sines};
pub use problem::{DistanceProblem, PassRoom, ReducedDistance, TileRows};
pub use solve::{WarmFit, solve_distances, solve_distances_warm};
pub use trigonometry::sines_cosines;
