//! Which rig tells which parameters of a device before anything is measured, and which poses to measure next.
//!
#![doc = include_str!("../README.md")]

mod candidates;
mod clearance;
mod criterion;
mod equip;
mod error;
mod exchange;
mod gains;
mod information;
mod kind;
mod next_poses;
mod plan;
mod posture;
mod select;
mod state;
mod suggest;
mod task;
mod touches;
mod whitened;

pub use candidates::{Limits, Spread, candidates};
pub use criterion::Criterion;
pub use equip::{DEGREE, Equipped, Terms, equip};
pub use error::DesignError;
pub use exchange::Search;
pub use information::Information;
pub use kind::{KINDS, Kind, Measure, Rig};
pub use next_poses::{NextPoses, Predicted};
pub use plan::{ParameterTold, Plan, Request, RigTells, Step, Told, described_rigs, plan};
pub use posture::{Posture, postures};
pub use select::{Figures, Selection, driving_order, select};
pub use suggest::{Remedy, Suggestion, suggestions};
pub use task::{Region, task_rows};
