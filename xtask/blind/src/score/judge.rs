//! One answer against one truth.

use std::collections::BTreeMap;

use serde::Serialize;

use super::answer::{Answer, Cause, Verdict, plain_name};
use super::besides::{is_allowed, is_forbidden};
use super::reduction::TrueReduction;
use crate::truth::{EffectTruth, Truth};

/// Whether an interval holds a true parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Coverage {
    /// Effect.
    pub effect: String,
    /// Parameter.
    pub parameter: String,
    /// True value.
    pub truth: f64,
    /// Stated value.
    pub value: f64,
    /// Stated interval.
    pub ci95: [f64; 2],
    /// Whether it holds the truth.
    pub covered: bool,
}

/// Whether an interval holds the true reduction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShrinkScore {
    /// Channel.
    pub channel: String,
    /// Stated reduction \[%\].
    pub stated_percent: Option<f64>,
    /// True reduction \[%\].
    pub true_percent: f64,
    /// Whether the stated interval holds it; absent without an interval.
    pub covered: Option<bool>,
}

/// Score of one trial.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrialScore {
    /// Suite.
    pub suite: String,
    /// Index in the batch.
    pub index: u64,
    /// Device.
    pub device: String,
    /// Label of the truth.
    pub name: String,
    /// Number of effects that had to be named.
    pub groups: usize,
    /// Whether the truth is clean.
    pub is_clean: bool,
    /// Whether no name is right.
    pub is_unknown: bool,
    /// Verdict.
    pub verdict: Verdict,
    /// First cause, or the verdict where there is none.
    pub answered: String,
    /// Any verdict but `no-gap`.
    pub detected: bool,
    /// The answer is right: see [`judge`].
    pub right: bool,
    /// Groups of the truth found among the causes or their declared twins.
    pub groups_found: usize,
    /// The first name alone is right.
    pub top_right: bool,
    /// The joint of the first group is right; absent where it has none or was not found.
    pub joint_right: Option<bool>,
    /// One of the columns that an effect in no catalogue depends on is named; absent where the truth has
    /// none or nothing was detected.
    pub dependence_right: Option<bool>,
    /// Size of the first cause's declared class.
    pub class_size: Option<usize>,
    /// Causes that were not put in.
    pub false_causes: usize,
    /// Where the magnitude is beyond the physical bound: whether a cause says so, or no name is given.
    pub implausible_flagged: Option<bool>,
    /// Verdict `named`, and wrong.
    pub confidently_wrong: bool,
    /// Probability of what is answered, and whether that is right; absent for `no-gap`.
    pub probability: Option<(f64, bool)>,
    /// Parameters of the causes found.
    pub coverage: Vec<Coverage>,
    /// Reduction on the second recording.
    pub shrink: Option<ShrinkScore>,
}

/// Judges an answer; `reductions` are the true ones of the second recording, where known.
///
/// Right is: `no-gap` for a clean truth, and where it is said to be right; `unknown` (or acceptable names alone) where no name
/// is right;
/// else a verdict `named` or `ambiguous` with one name of every group of the truth among the causes or
/// what they are declared to be confused with; and what the truth allows besides.
pub fn judge(
    truth: &Truth,
    answer: &Answer,
    reductions: &BTreeMap<String, TrueReduction>,
) -> TrialScore {
    let detected = answer.verdict != Verdict::NoGap;
    let names_causes = matches!(answer.verdict, Verdict::Named | Verdict::Ambiguous);
    let causes: &[Cause] = if names_causes { &answer.causes } else { &[] };
    let in_group = |name: &str, group: &[String]| group.iter().any(|right| right == name);
    let is_of = |cause: &Cause, group: &[String]| {
        let is_placed = truth.besides.is_of_whole && cause.joint.is_some();
        !is_placed && cause.names().any(|name| in_group(name, group))
    };
    let is_acceptable = |cause: &Cause| is_of(cause, &truth.acceptable);
    let is_found = |group: &&Vec<String>| causes.iter().any(|cause| is_of(cause, group));
    let groups_found = truth.right.iter().filter(is_found).count();
    let belongs = |cause: &Cause| truth.right.iter().any(|group| is_of(cause, group));
    let false_causes = causes
        .iter()
        .filter(|cause| !belongs(cause) && !is_acceptable(cause))
        .count();
    let twins_alone = !causes.is_empty() && causes.iter().all(is_acceptable);
    let all_found = names_causes && groups_found == truth.right.len() && groups_found > 0;
    let right = if truth.is_clean() {
        !detected
    } else if truth.is_unknown() {
        answer.verdict == Verdict::Unknown || twins_alone || (truth.no_gap_is_right && !detected)
    } else {
        all_found || (truth.no_gap_is_right && !detected)
    };
    let right = (right || is_allowed(truth, answer)) && !is_forbidden(truth, answer);
    let first = causes.first();
    let top_right = first.is_some_and(|cause| {
        let name = plain_name(&cause.effect);
        truth.right.iter().any(|group| in_group(name, group))
    });
    let joint_right = truth.joint.and_then(|joint| {
        let group = truth.right.first()?;
        if truth.is_unknown() {
            let place = answer.place.as_ref()?;
            return detected.then_some(place.joint == Some(joint));
        }
        // of several causes with the right name the one at the right joint counts
        let mut named = causes.iter().filter(|cause| is_of(cause, group)).peekable();
        named.peek()?;
        Some(named.any(|cause| cause.joint == Some(joint)))
    });
    TrialScore {
        suite: truth.suite.clone(),
        index: truth.index,
        device: truth.device.clone(),
        name: truth.name.clone(),
        groups: truth.right.len(),
        is_clean: truth.is_clean(),
        is_unknown: truth.is_unknown(),
        verdict: answer.verdict,
        answered: first.map_or_else(
            || answer.verdict.text().to_owned(),
            |cause| plain_name(&cause.effect).to_owned(),
        ),
        detected,
        right,
        groups_found,
        top_right,
        joint_right,
        dependence_right: dependence(truth, answer),
        class_size: first.map(|cause| cause.names().count()),
        false_causes,
        implausible_flagged: truth.implausible.then(|| {
            answer.verdict == Verdict::Unknown
                || causes.iter().any(|cause| cause.plausible == Some(false))
        }),
        confidently_wrong: answer.verdict == Verdict::Named && !right,
        probability: probability(answer, truth),
        coverage: coverage(truth, causes),
        shrink: shrink(answer, causes, reductions),
    }
}

/// Probability of the first cause, or of `unknown` where that is the verdict, and whether it is so. A
/// name must be one of its group at the group's joint; one that is answered with its twins must be the
/// very effect that was put in, for the probability is shared with them.
fn probability(answer: &Answer, truth: &Truth) -> Option<(f64, bool)> {
    if answer.verdict == Verdict::NoGap {
        return None;
    }
    if answer.verdict == Verdict::Unknown {
        let others = answer.causes.iter().filter_map(|cause| cause.probability);
        let probability = answer
            .probability_unknown
            .unwrap_or_else(|| 1.0 - others.fold(0.0, f64::max));
        return Some((probability, truth.is_unknown()));
    }
    let cause = answer.causes.first()?;
    let name = plain_name(&cause.effect);
    let is_right = if answer.verdict == Verdict::Ambiguous {
        let mut effects = truth.effects.iter();
        !truth.is_unknown()
            && effects.any(|effect| {
                effect.effect == name && (effect.joint.is_none() || effect.joint == cause.joint)
            })
    } else {
        let mut groups = truth.right.iter().zip(&truth.joints);
        groups.any(|(group, joint)| {
            group.iter().any(|right| right == name) && (joint.is_none() || *joint == cause.joint)
        })
    };
    Some((cause.probability?, is_right))
}

/// Whether a column that is named has the stem of one that the truth depends on (an external encoder's
/// column stands for its joint's, `time` for `t_s`).
fn dependence(truth: &Truth, answer: &Answer) -> Option<bool> {
    if truth.depends_on.is_empty() || answer.verdict == Verdict::NoGap {
        return None;
    }
    let named = answer.place.iter().flat_map(|place| &place.depends_on);
    let is_so = |text: &String, stem: &String| {
        let text = text.replace("out", "theta").replace("time", "t_s");
        text.match_indices(stem.as_str()).any(|(at, _)| {
            // `theta1` is not in `theta12`
            !text[at + stem.len()..].starts_with(|next: char| next.is_ascii_digit())
        })
    };
    let mut pairs = named.flat_map(|text| truth.depends_on.iter().map(move |stem| (text, stem)));
    Some(pairs.any(|(text, stem)| is_so(text, stem)))
}

/// Parameters whose sign is a matter of convention are compared by size.
fn is_signed(parameter: &str) -> bool {
    parameter == "delay_s" || parameter == "time_s"
}

/// Truth and answer of every parameter that both have, for causes at the right joint.
fn coverage(truth: &Truth, causes: &[Cause]) -> Vec<Coverage> {
    let same = |cause: &&Cause, effect: &EffectTruth| {
        plain_name(&cause.effect) == effect.effect
            && (effect.joint.is_none() || cause.joint == effect.joint)
    };
    let mut all = Vec::new();
    for effect in &truth.effects {
        let Some(cause) = causes.iter().find(|cause| same(cause, effect)) else {
            continue;
        };
        for (name, value) in &effect.parameters {
            let Some(stated) = cause.parameters.get(name) else {
                continue;
            };
            let (Some(estimate), Some([low, high])) = (stated.value, stated.ci95) else {
                continue;
            };
            let flip = !is_signed(name) && (estimate < 0.0) != (*value < 0.0);
            let compared = if flip { -value } else { *value };
            all.push(Coverage {
                effect: effect.effect.clone(),
                parameter: name.clone(),
                truth: *value,
                value: estimate,
                ci95: [low, high],
                covered: low <= compared && compared <= high,
            });
        }
    }
    all
}

/// The stated reduction of the first cause's channel against the true one.
fn shrink(
    answer: &Answer,
    causes: &[Cause],
    reductions: &BTreeMap<String, TrueReduction>,
) -> Option<ShrinkScore> {
    let held_out = causes.first()?.held_out.as_ref()?;
    let channel = held_out.channel.as_deref()?;
    let true_percent = reductions.get(channel)?.percent?;
    // after several causes only the channel's own entry is comparable with the predictions
    let mut channels = answer.gap.channels.iter();
    let of_channel = channels.find(|one| one.channel == channel);
    let (stated_percent, interval) = match (causes.len(), of_channel) {
        (2.., Some(all)) => (all.reduction_percent, all.reduction_ci95),
        _ => (held_out.reduction_percent, held_out.reduction_ci95),
    };
    Some(ShrinkScore {
        channel: channel.to_owned(),
        stated_percent,
        true_percent,
        covered: interval.map(|[low, high]| low <= true_percent && true_percent <= high),
    })
}
