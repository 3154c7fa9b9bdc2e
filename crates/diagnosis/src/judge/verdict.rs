//! The verdict: no gap, a name, several that cannot be distinguished, or a gap without a name.

use haptical_effects::{Family, Parameter};

use crate::answer::{CauseAnswer, HeldOutAnswer, Verdict};
use crate::force::answer::ForceAnswer;
use crate::judge::findings::Findings;
use crate::select::excess;
use crate::thresholds::chance::{MOST_NAMES, NAMED_PROBABILITY};
use crate::thresholds::partial::{LEAST_PROBABILITY, MOST_LEFT_OF_SECOND};
use crate::thresholds::rivals::LATER_PROBABILITY;

/// The verdict on the causes that positions show.
pub(crate) fn verdict(findings: &Findings<'_>, causes: &[CauseAnswer]) -> Verdict {
    let base_terms = &findings.base_terms;
    let first = causes.first();
    // where a tool was changed the rest may be as small as the tool's own law gets wrong
    if base_terms.accounts_for(excess(&findings.selection.after).0) {
        return by_probability(first);
    }
    if findings.selection.causes().is_empty() {
        return match (findings.is_quiet(), causes.is_empty()) {
            (true, true) if !base_terms.is_unnamed => Verdict::NoGap,
            (true, false) if !base_terms.is_partial => Verdict::Named,
            _ => Verdict::Unknown,
        };
    }
    let is_hedged = first.is_some_and(|cause| kinds_beside(cause) >= MOST_NAMES);
    let is_void = base_terms.terms.is_empty() && !first.is_some_and(is_credible)
        || contradicted(findings, causes).is_some();
    let is_of_cables = (findings.partial.as_ref()).is_some_and(|partial| partial.is_of_cables);
    let is_likely = first.is_some_and(|cause| {
        let probability = match is_of_cables {
            true => cause.class_probability,
            false => cause.probability,
        };
        probability >= LEAST_PROBABILITY
    });
    let is_supported = findings.adequacy.is_adequate || (findings.partial.is_some() && is_likely);
    if !is_supported || is_hedged || is_void {
        return Verdict::Unknown;
    }
    by_probability(first)
}

/// The verdict where positions show no gap: by the torques' first finding, or by their gap without one.
pub(crate) fn of_torques(findings: &Findings<'_>) -> Verdict {
    by_torques(&findings.force)
}

/// The same of torques alone.
pub(crate) fn by_torques(force: &ForceAnswer) -> Verdict {
    match force.findings.first() {
        None if force.unexplained().is_some() => Verdict::Unknown,
        None => Verdict::NoGap,
        first => by_probability(first),
    }
}

fn by_probability(first: Option<&CauseAnswer>) -> Verdict {
    match first.is_some_and(|cause| cause.probability >= NAMED_PROBABILITY) {
        true => Verdict::Named,
        false => Verdict::Ambiguous,
    }
}

/// Whether a cause has a size, and does not make predictions of what the fit did not see worse.
fn is_credible(cause: &CauseAnswer) -> bool {
    let mut sizes = sizes(cause).peekable();
    let has_size = sizes.peek().is_none() || sizes.any(|ci95| ci95[0] * ci95[1] > 0.0);
    let is_worse =
        |held_out: &HeldOutAnswer| held_out.reduction_ci95.is_some_and(|ci95| ci95[1] <= 0.0);
    has_size && !cause.held_out.as_ref().is_some_and(is_worse)
}

/// Share of the squares beyond noise that a moving arm's first cause leaves of a second recording, where that is more than it
/// may (A201).
pub(crate) fn contradicted(findings: &Findings<'_>, causes: &[CauseAnswer]) -> Option<f64> {
    let inputs = &findings.inputs;
    if inputs.moving.is_none() || inputs.options.validation.is_none() {
        return None;
    }
    let left = causes.first()?.held_out.as_ref()?.left()?;
    (left > MOST_LEFT_OF_SECOND).then_some(left)
}

/// Whether a later cause is more than what an earlier one's law gets wrong: its class is likely and
/// small, and its size is not zero.
pub(crate) fn is_reported(cause: &CauseAnswer) -> bool {
    cause.class_probability >= LATER_PROBABILITY
        && kinds_beside(cause) < MOST_NAMES
        && sizes(cause).all(|ci95| ci95[0] * ci95[1] > 0.0)
}

/// Kinds of effects that a cause is confusable with: whatever yields to a load is one.
fn kinds_beside(cause: &CauseAnswer) -> usize {
    let yields = |name: &str| {
        let spec = haptical_effects::spec(name);
        spec.is_some_and(|spec| spec.family == Family::Load)
    };
    let rivals = cause.confusable_with.iter();
    let springs = rivals.clone().filter(|name| yields(name)).count();
    let others = rivals.count() - springs;
    others + usize::from(springs > 0 && !yields(&cause.effect))
}

/// Intervals of a cause's sizes, not of their places.
fn sizes(cause: &CauseAnswer) -> impl Iterator<Item = [f64; 2]> {
    let is_size = |name: &str| {
        haptical_effects::parameter(&cause.effect, name).is_none_or(Parameter::is_size)
    };
    let sizes = cause.parameters.iter();
    sizes
        .filter(move |(name, _)| is_size(name))
        .map(|(_, size)| size.ci95)
}
