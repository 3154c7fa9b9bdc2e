//! What a truth allows besides its names, or forbids whatever is named: refusals, `unknown`, what an answer says.

use std::collections::BTreeMap;

use super::answer::{Answer, Verdict};
use super::judge::{TrialScore, judge};
use crate::truth::{Said, Truth};

/// What is answered in the place of a verdict.
const REFUSAL: &str = "refusal";
/// An error that nobody meant.
const PANIC: &str = "panic:";
/// Numbers of drives: others that are adjusted are of bodies.
const OF_DRIVES: [&str; 2] = ["friction", "armature"];
/// Of a warning that lists readings which are none.
const LEFT_OUT: [&str; 2] = ["count for nothing", "repeat the one before"];

/// Whether an answer is right that names nothing.
pub(super) fn is_allowed(truth: &Truth, answer: &Answer) -> bool {
    let besides = &truth.besides;
    match answer.verdict {
        Verdict::Unknown => {
            let refused = answer.admission.iter();
            let mut refused = refused.filter(|(_, check)| check.answer == "no");
            let is_meant = |(name, check): (&String, _)| says(truth, &reason(name, check));
            besides.unknown || refused.any(is_meant)
        }
        Verdict::NoGap => besides
            .no_gap_with
            .is_some_and(|what| has_said(answer, what)),
        Verdict::Named | Verdict::Ambiguous => false,
    }
}

/// Whether an answer is wrong whatever it names.
pub(super) fn is_forbidden(truth: &Truth, answer: &Answer) -> bool {
    let second = answer.second_recording.as_ref();
    let closes = second.is_some_and(|second| {
        !second.channels.is_empty() && second.channels.iter().all(|channel| !channel.has_gap)
    });
    truth.besides.second_is_foreign && closes
}

/// The score of an error in the place of an answer; none where the truth has no such one among its right answers.
pub fn judge_refusal(truth: &Truth, error: &str) -> Option<TrialScore> {
    let is_right = !error.starts_with(PANIC) && says(truth, error);
    let nothing = Answer {
        verdict: Verdict::Unknown,
        gap: super::Gap::default(),
        place: None,
        causes: Vec::new(),
        probability_unknown: None,
        admission: BTreeMap::new(),
        adjusted: Vec::new(),
        second_recording: None,
        warnings: Vec::new(),
    };
    is_right.then(|| TrialScore {
        answered: REFUSAL.to_owned(),
        right: true,
        joint_right: None,
        dependence_right: None,
        probability: None,
        ..judge(truth, &nothing, &BTreeMap::new())
    })
}

/// A question's name and why it is answered with no.
fn reason(name: &str, check: &super::Check) -> String {
    format!("{name}: {}", check.why)
}

fn says(truth: &Truth, text: &str) -> bool {
    let mut words = truth.besides.refusals.iter();
    words.any(|words| text.contains(words.as_str()))
}

fn has_said(answer: &Answer, what: Said) -> bool {
    match what {
        Said::Dropouts => {
            let mut warnings = answer.warnings.iter();
            warnings.any(|warning| LEFT_OUT.iter().any(|words| warning.contains(words)))
        }
        Said::Bodies => {
            let mut adjusted = answer.adjusted.iter();
            adjusted.any(|number| !OF_DRIVES.contains(&number.name.as_str()))
        }
        Said::Impossible => {
            let mut warnings = answer.warnings.iter();
            warnings.any(|warning| warning.contains("that no body has"))
        }
    }
}
