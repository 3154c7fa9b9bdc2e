//! Hedges of the first cause beyond its own evidence: rivals that no scan could list, and how little
//! a name is worth that explains a part of a gap only.

use haptical_effects::Effect;

use crate::answer::{CauseAnswer, IN_NO_CATALOGUE, Verdict};
use crate::judge::earlier_model::{BaseTerm, Difference};
use crate::judge::findings::Findings;
use crate::thresholds::chance::CONFUSABLE_NATS;

/// Gives the first cause the rivals and the probability that belong to it.
pub(crate) fn hedge(findings: &Findings<'_>, verdict: Verdict, causes: &mut [CauseAnswer]) {
    match verdict {
        Verdict::Unknown => {
            let unknown = findings.adequacy.probability_unknown(verdict);
            doubt_partial(causes, &findings.base_terms, unknown);
        }
        Verdict::Ambiguous => complete_rivals(findings, causes),
        Verdict::NoGap | Verdict::Named => {}
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

/// Completes the rivals of a first cause that is not sure. Where no effect of the catalogue is one, the weak gap may be
/// that of an effect in no catalogue.
fn complete_rivals(findings: &Findings<'_>, causes: &mut [CauseAnswer]) {
    let Some(first) = causes.first_mut() else {
        return;
    };
    if first.confusable_with.is_empty() {
        first.confusable_with = unlisted_rivals(findings);
    }
    if first.confusable_with.is_empty() {
        first.confusable_with.push(IN_NO_CATALOGUE.to_owned());
    }
}

/// What the first cause may be taken for although no other name refits as well: itself at another place, and
/// effects of the same course at its place whose covariate was not recorded (a cable that creeps under a load
/// that no torque tells drifts as a joint that follows the time).
fn unlisted_rivals(findings: &Findings<'_>) -> Vec<String> {
    let Some(first) = findings.first() else {
        return Vec::new();
    };
    let mut names: Vec<String> = Vec::new();
    let elsewhere = findings.rivals.first().is_some_and(|list| {
        let mut others = list.iter().skip(1);
        others.any(|rival| rival.name == first.name() && rival.nats_behind <= CONFUSABLE_NATS)
    });
    if elsewhere {
        names.push(first.name().to_owned());
    }
    let context = &findings.engine().context;
    let untried = |effect: &(dyn Effect + 'static)| {
        effect.is_kin_of(first) && effect.name() != first.name() && effect.lacks_covariate(context)
    };
    for effect in findings
        .selection
        .selector
        .effects
        .iter()
        .map(AsRef::as_ref)
    {
        if untried(effect) && !names.iter().any(|name| name == effect.name()) {
            names.push(effect.name().to_owned());
        }
    }
    names
}
