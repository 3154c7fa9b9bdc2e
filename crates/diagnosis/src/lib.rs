//! Names the unmodelled effect behind what a calibration leaves, or declines.
//!
#![doc = include_str!("../README.md")]

mod adequacy;
mod advice;
mod answer;
mod assemble;
mod base;
mod blocks;
mod catalogue;
mod causes;
mod cleaning;
mod contend;
mod context;
mod diagnose;
mod earlier;
mod engine;
mod error;
mod events;
mod force;
mod frames;
mod generic;
mod laws;
mod measured;
mod model;
mod noise;
mod options;
mod part;
mod place;
mod refit;
mod rivals;
mod scan;
mod select;
mod shrink;
mod signal;
mod system;
mod tables;
mod thresholds;
mod trim;
mod unseen;
mod wrong_angles;

pub use answer::{
    CandidateAnswer, CauseAnswer, ChannelGap, Detectable, Diagnosis, Gap, HeldOutAnswer, Hint,
    Invisible, NoiseAnswer, ParameterAnswer, Place, Prediction, Provenance, Trace, Untestable,
    Verdict,
};
pub use catalogue::Hook;
pub use diagnose::{diagnose, effect_names, plausible_range};
pub use error::DiagnosisError;
pub use options::Options;
