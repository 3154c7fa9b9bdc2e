//! Plans measurements: the parameters that a rig would identify, and the poses to measure next.
//!
#![doc = include_str!("../README.md")]

mod equip;
mod error;
mod information;
mod kind;
mod motion;
mod plan;
mod posture;
mod select;
mod suggest;
mod task;

pub use equip::{DEGREE, Equipped, Terms, equip};
pub use error::DesignError;
pub use information::Information;
pub use kind::{KINDS, Kind, Measure, Rig, Tracking};
pub use motion::{Motion, Motions, path, pieces};
pub use plan::{ParameterStatus, Plan, Request, RigIdentifiability, Step, described_rigs, plan};
pub use posture::candidates::{Limits, Spread, candidates};
pub use posture::{Posture, postures};
pub use select::criterion::Criterion;
pub use select::exchange::Search;
pub use select::next_poses::{NextPoses, Predicted};
pub use select::{Figures, Selection, driving_order, select};
pub use suggest::{Remedy, Suggestion, suggestions};
pub use task::{Region, task_rows};
