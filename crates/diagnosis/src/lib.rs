//! Names the unmodelled effect behind what a calibration leaves, or declines.
//!
#![doc = include_str!("../README.md")]

mod admission;
mod answer;
mod current;
mod diagnose;
mod dropouts;
mod engine;
mod error;
mod force;
mod hand;
mod joined;
mod judge;
mod log;
mod moving;
mod noise;
mod options;
mod outlying;
mod own_effects;
mod second_round;
mod select;
mod servo_loop;
mod settle;
mod start_values;
#[cfg(test)]
mod statics_tests;
mod thresholds;
mod torques_alone;
mod version;

pub use answer::BESIDE_TORQUES;
pub use answer::BOOTSTRAP_SEED;
pub use answer::{
    AbsorbedAnswer, AdjustedAnswer, Asked, CandidateAnswer, CauseAnswer, ChannelGap,
    CorrectionAnswer, Dependence, Detectable, Diagnosis, FitRows, Gap, HeldOutAnswer, Hint,
    IN_NO_CATALOGUE, Invisible, MovedNumber, NoReduction, NoiseAnswer, Over, OwnModel,
    ParameterAnswer, Place, Prediction, Provenance, Refusal, RefusedCorrection, SECOND_RECORDING,
    SecondAnswer, SecondChannel, StepAnswer, TORQUES_NOT_TESTED, Trace, Untestable, Verdict,
    Whiteness,
};
pub use diagnose::diagnose;
pub use error::DiagnosisError;
use error::Result;
pub use force::asked::{AskedOfTorques, ask_torques};
pub use haptical_effects::{Hook, names as effect_names, plausible_range};
pub use haptical_judge::{Admission, Answered, Check};
pub use moving::between::{NumberOfCause, effects_between};
pub use moving::with_carried_loads;
pub use noise::NoiseSource;
pub use options::{Catalogue, Options};
pub use outlying::outlying_readings;
pub use settle::{Candidate, Odds, Pieces, Question, Settler, inseparable, score};
pub use start_values::start_values;
pub use torques_alone::BEHIND_A_LOW_PASS;
