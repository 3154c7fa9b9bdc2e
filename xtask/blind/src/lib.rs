//! Blind trials of a diagnosis: recordings with a hidden effect, sealed truths, scores.
//!
#![doc = include_str!("../README.md")]
#![allow(
    clippy::missing_errors_doc,
    reason = "the errors are texts for a person"
)]

/// An array of structs, a row each.
///
/// ```
/// struct Planet { name: &'static str, moons: u32 }
/// const NEAR: [Planet; 2] = xtask_blind::rows! { Planet {name moons} "Venus", 0; "Earth", 1; };
/// assert_eq!((NEAR[1].name, NEAR[1].moons), ("Earth", 1));
/// ```
#[macro_export]
macro_rules! rows {
    (@ $type:ident {$($field:ident)+} $($value:expr),+) => { $type { $($field: $value),+ } };
    ($type:ident $fields:tt $($($value:expr),+;)+) => { [$($crate::rows!(@ $type $fields $($value),+)),+] };
}

/// Numbers under their names.
macro_rules! named {
    ($($number:ident),+) => { [$((stringify!($number), $number)),+] };
}

mod again;
mod arms;
mod colour;
mod effects;
mod files;
mod gap;
mod laws;
mod loop_suites;
mod moving;
mod payload_suites;
mod planted;
mod random;
mod rig;
mod score;
mod seal;
mod suites;
mod trial;
mod truth;
mod wrist;

pub use again::{Again, Led};
pub use effects::{Draw, Effect, Facts, Group, Info, KINDS, Kind, kind};
pub use files::write_trial;
pub use gap::ChannelGapTruth;
pub use moving::write_moving;
pub use random::Random;
pub use rig::devices::{NOMINALS, Nominal, perturbed, torque_scales};
pub use rig::dynamics::Dynamics;
pub use rig::geometry::{Chain, Flex, HandlePose};
pub use rig::motion::{Motion, MotionPlan};
pub use rig::noise::{ChannelNoise, NoisePlan};
pub use rig::scene::{CablePath, CleanChannels, Recorded, Scene};
pub use score::{
    Adjusted, Answer, Calibration, Cause, ChannelGap, Check, Coverage, Gap, HeldOut,
    ParameterAnswer, Prediction, Rate, SecondChannel, SecondRecording, ShrinkScore, Summary,
    TrialScore, TrueReduction, Verdict, Where, channel_of, closed_percent, judge, judge_refusal,
    summarise, true_reductions,
};
pub use seal::{Sealed, seal, sha256_hex};
pub use suites::Suite;
pub use trial::{Asked, Trial};
pub use truth::{Besides, EffectTruth, Event, Said, Truth};
