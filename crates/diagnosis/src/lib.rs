//! Names the unmodelled effect behind what a calibration leaves, or declines.
//!
#![doc = include_str!("../README.md")]

mod adequacy;
mod advice;
mod anchor;
mod answer;
mod assemble;
mod base;
mod blocks;
mod causes;
mod cleaning;
mod contend;
mod dependence;
mod diagnose;
mod earlier;
mod earlier_model;
mod engine;
mod error;
mod events;
mod force;
mod generic;
mod laws;
mod least;
mod measured;
mod model;
mod noise;
mod onto_touches;
mod options;
mod part;
mod place;
mod place_touched;
mod refit;
mod rivals;
mod scan;
mod select;
mod shrink;
#[cfg(test)]
mod statics_tests;
mod system;
mod tables;
mod thresholds;
mod too_coarse;
mod tool;
mod touched;
mod trim;
mod unlisted;
mod unseen;
mod wrong_angles;

pub use answer::{
    Asked, CandidateAnswer, CauseAnswer, ChannelGap, Dependence, Detectable, Diagnosis, Gap,
    HeldOutAnswer, Hint, Invisible, NoiseAnswer, ParameterAnswer, Place, Prediction, Provenance,
    Trace, Untestable, Verdict,
};
pub use diagnose::diagnose;
pub use error::DiagnosisError;
pub use haptical_effects::{Hook, names as effect_names, plausible_range};
pub use options::Options;
pub use shrink::BOOTSTRAP_SEED;
pub use unlisted::IN_NO_CATALOGUE;
