//! Scores of a diagnosis against the truth: one trial at a time, then over a batch.

mod answer;
mod besides;
mod interval;
mod judge;
mod reduction;
mod summary;

pub use answer::{
    Adjusted, Answer, Cause, ChannelGap, Check, Gap, HeldOut, ParameterAnswer, SecondChannel,
    SecondRecording, Verdict, Where,
};
pub use besides::judge_refusal;
pub use interval::Rate;
pub use judge::{Coverage, ShrinkScore, TrialScore, judge};
pub use reduction::{Prediction, TrueReduction, channel_of, closed_percent, true_reductions};
pub use summary::{Calibration, Summary, summarise};
