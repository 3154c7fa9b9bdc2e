//! How a joint answers its command: offset, lag, friction, droop and gain, and where they change within a log.
//!
#![doc = include_str!("../README.md")]

mod answer;
mod change;
mod effect;
mod episodes;
mod fit;
mod joint;
mod log;
mod next;
mod noise;
mod predict;
mod select;
mod thresholds;

pub use answer::{Course, Finding, Instant, JointAnswer, Number, Verdict};
pub use change::torque_gain;
pub use effect::NAMES;
pub use episodes::{
    EpisodeFinding, EpisodeLog, EpisodeReport, EpisodeVerdict, Fault, JointColumns, JointEpisodes,
    RowFault, RowFaultKind, Side, Use, examine_episodes,
};
pub use joint::{diagnose_joint, untested};
pub use log::{JointLog, Untested};
pub use predict::Predicted;

/// Text of the file with the numbers that decide: `haptical-diagnosis` makes a version of it.
pub const THRESHOLDS: [&str; 1] = [include_str!("thresholds.rs")];
