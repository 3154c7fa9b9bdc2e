//! Hedges of the first cause beyond its own evidence: rivals that no scan could list, and how little
//! a name is worth that explains a part of a gap only.

use haptical_effects::Effect;

use crate::answer::{CauseAnswer, Verdict};
use crate::judge::earlier::{BaseTerm, Difference};
use crate::judge::rivals::Rival;
use crate::select::{Selection, Selector};
use crate::thresholds::chance::CONFUSABLE_NATS;

/// Among what a cause may be taken for: an effect that is in no catalogue.
pub const IN_NO_CATALOGUE: &str = "unknown";

/// The verdict once the first cause has the rivals and the probability that belong to it; `unknown` is that no
/// effect of the catalogue is the cause.
pub(crate) fn hedged(
    selector: &Selector<'_, '_>,
    selection: &Selection,
    rivals: &[Vec<Rival>],
    (verdict, unknown): (Verdict, f64),
    base_terms: &Difference,
    causes: &mut [CauseAnswer],
) -> Verdict {
    match verdict {
        Verdict::Unknown => {
            doubt_partial(causes, base_terms, unknown);
            verdict
        }
        Verdict::Ambiguous => with_rivals(selector, selection, rivals, causes),
        Verdict::NoGap | Verdict::Named => verdict,
    }
}

/// What explains a part of a gap that is none of the catalogue's has the probability that it is one after all.
fn doubt_partial(causes: &mut [CauseAnswer], base_terms: &Difference, unknown: f64) {
    let is_term = |cause: &CauseAnswer| {
        let same = |term: &BaseTerm| term.name == cause.effect;
        base_terms.terms.iter().any(same)
    };
    for cause in causes.iter_mut().filter(|cause| !is_term(cause)) {
        cause.probability *= 1.0 - unknown;
        cause.class_probability *= 1.0 - unknown;
    }
}

/// The verdict on a first cause that is not sure: its rivals are completed. Where no effect of the catalogue is one,
/// the weak gap may be that of an effect in no catalogue.
fn with_rivals(
    selector: &Selector<'_, '_>,
    selection: &Selection,
    rivals: &[Vec<Rival>],
    causes: &mut [CauseAnswer],
) -> Verdict {
    let Some(first) = causes.first_mut() else {
        return Verdict::Ambiguous;
    };
    if first.confusable_with.is_empty() {
        first.confusable_with = unlisted_rivals(selector, selection, rivals);
    }
    if first.confusable_with.is_empty() {
        first.confusable_with.push(IN_NO_CATALOGUE.to_owned());
    }
    Verdict::Ambiguous
}

/// What the first cause may be taken for although no other name refits as well: itself at another place, and
/// effects of the same course at its place whose covariate was not recorded (a cable that creeps under a load
/// that no torque tells drifts as a joint that follows the time).
fn unlisted_rivals(
    selector: &Selector<'_, '_>,
    selection: &Selection,
    rivals: &[Vec<Rival>],
) -> Vec<String> {
    let Some(cause) = selection.refit.model.causes.first() else {
        return Vec::new();
    };
    let first = selector.effects[cause.effect].as_ref();
    let mut names: Vec<String> = Vec::new();
    let elsewhere = rivals.first().is_some_and(|list| {
        let mut others = list.iter().skip(1);
        others.any(|rival| rival.name == first.name() && rival.nats_behind <= CONFUSABLE_NATS)
    });
    if elsewhere {
        names.push(first.name().to_owned());
    }
    let context = &selector.engine.context;
    let untried = |effect: &(dyn Effect + 'static)| {
        effect.is_kin_of(first) && effect.name() != first.name() && effect.lacks_covariate(context)
    };
    for effect in selector.effects.iter().map(AsRef::as_ref) {
        if untried(effect) && !names.iter().any(|name| name == effect.name()) {
            names.push(effect.name().to_owned());
        }
    }
    names
}
