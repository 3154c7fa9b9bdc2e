//! Rivals: effects that explain as much in a cause's place, and how far behind they are.

use haptical_effects::{Context, Effect, Family, Follows};

use crate::DiagnosisError;
use crate::engine::model::{Cause, Refit};
use crate::select::rival::Rival;
use crate::select::scan::Score;
use crate::select::{Selection, Selector, misfit};
use crate::thresholds::chance::CONFUSABLE_NATS;
use crate::thresholds::rivals::{
    BEHIND_NATS, COUPLED, DRIFT_LAW, EXCHANGES, LEAD, LISTED, LOOK_ALIKE, LOOK_ALIKE_NATS,
    NEAR_NATS, REFITTED, SAME_COURSE, SAME_GAIN, SETTLING_COURSES,
};

/// Every cause's rivals, after causes that others have overtaken were exchanged.
pub(crate) fn settle(selection: &mut Selection<'_>) -> Result<Vec<Vec<Rival>>, DiagnosisError> {
    let mut lists: Vec<Vec<Rival>> = Vec::new();
    for round in 0..=EXCHANGES {
        lists.clear();
        let mut changed = false;
        for cause in 0..selection.causes().len() {
            let list = rivals(selection, cause)?;
            let by_lead = |a: &&Rival, b: &&Rival| a.nats_behind.total_cmp(&b.nats_behind);
            let behind = list.first().map_or(0.0, |own| own.nats_behind);
            let leader = list.iter().skip(1).min_by(by_lead);
            if round < EXCHANGES
                && behind > LEAD
                && let Some(leader) = leader.and_then(|rival| rival.cause.clone())
                && selection.replace(cause, leader)?
            {
                changed = true;
            }
            lists.push(list);
        }
        if !changed {
            break;
        }
    }
    Ok(lists)
}

/// The cause itself and its rivals, best first.
pub(crate) fn rivals(
    selection: &mut Selection<'_>,
    cause: usize,
) -> Result<Vec<Rival>, DiagnosisError> {
    let selector = &mut selection.selector;
    let causes = &selection.refit.model.causes;
    let (without, scan) = if causes.len() == 1 {
        (selector.engine.start.clone(), selection.first_scan.clone())
    } else {
        let mut model = selection.refit.model.clone();
        model.causes.remove(cause);
        let refit = selector.engine.refit(selector.effects, &model)?;
        let system = selector.system_of(&refit);
        let scan = selector.scan(&system, &refit.model);
        (refit, scan)
    };
    let misfit = misfit(&selection.after);
    let empty = selector.cost(&without);
    let gained = (empty - selector.cost(&selection.refit)).max(1e-9);
    let own = causes[cause].effect;
    let criterion = |score: f64, of: &Score| {
        selector.criterion(&Score {
            score: score / misfit,
            ..of.clone()
        })
    };
    // the linear score of a rival counts where its refit falls short; so does that of the cause itself
    let template = scan.iter().find(|score| score.effect == own).cloned();
    let template = template.unwrap_or_else(|| Score::of_cause(&causes[cause], gained));
    let explained = gained.max(template.score);
    let best = criterion(explained, &template);
    let mut evidence = vec![Evidence {
        effect: own,
        nats: best,
        share: 1.0,
        cause: None,
        has_converged: true,
    }];
    let others: Vec<&Score> = scan
        .iter()
        .filter(|score| score.effect != own)
        .take(LISTED)
        .collect();
    let is_near = |score: &Score| {
        best - criterion(score.score, score) < NEAR_NATS || score.score > SAME_GAIN * gained
    };
    let near: Vec<&Score> = others
        .iter()
        .copied()
        .filter(|score| is_near(score))
        .collect();
    let refits = haptical_parallel::map(near.into_iter().take(REFITTED), |score| {
        let (fitted, cost) = selector.refit_with(&without.model, score)?;
        Ok((score.effect, fitted, cost))
    });
    let refits: Vec<(usize, Refit, f64)> =
        refits.into_iter().collect::<Result<_, DiagnosisError>>()?;
    for score in others {
        let refit = refits.iter().find(|(effect, ..)| *effect == score.effect);
        // one that ended at no minimum may explain what its end still promises
        let explained = refit.map_or(score.score, |(_, fitted, cost)| {
            score.score.max(empty - cost + fitted.may_fall())
        });
        let has_converged = refit.is_none_or(|(_, fitted, _)| fitted.has_converged());
        let fit = refit.and_then(|(_, fitted, _)| fitted.model.causes.last().cloned());
        evidence.push(Evidence {
            effect: score.effect,
            nats: criterion(explained, score),
            share: explained / gained,
            cause: fit.filter(|_| has_converged),
            has_converged,
        });
    }
    hedge(selector, own, best, &mut evidence);
    Ok(listed(selector, own, evidence))
}

/// Evidence as probabilities, the cause itself first and then the best.
fn listed(selector: &Selector<'_>, own: usize, mut evidence: Vec<Evidence>) -> Vec<Rival> {
    evidence.sort_by(|a, b| b.nats.total_cmp(&a.nats));
    let top = evidence[0].nats;
    let sum: f64 = evidence.iter().map(|own| (own.nats - top).exp()).sum();
    let mut found: Vec<Rival> = evidence
        .into_iter()
        .map(|own| Rival {
            cause: own.cause,
            has_converged: own.has_converged,
            name: selector.effects[own.effect].name(),
            joint: selector.effects[own.effect].joint(),
            share: own.share,
            nats_behind: top - own.nats,
            probability: (own.nats - top).exp() / sum,
        })
        .collect();
    merge(&mut found);
    // the cause that was picked comes first
    if let Some(position) = found.iter().position(|rival| {
        rival.name == selector.effects[own].name() && rival.joint == selector.effects[own].joint()
    }) {
        let own = found.remove(position);
        found.insert(0, own);
    }
    found
}

/// What is known of an effect in a cause's place.
struct Evidence {
    /// Position in the catalogue.
    effect: usize,
    nats: f64,
    /// Share of what the cause explains.
    share: f64,
    /// Its fit, where it was refitted and ended at a minimum.
    cause: Option<Cause>,
    has_converged: bool,
}

/// Brings effects whose difference is a matter of their laws near to the cause.
fn hedge(selector: &Selector<'_>, own: usize, best: f64, evidence: &mut [Evidence]) {
    let own_effect = selector.effects[own].as_ref();
    let is_warming = warms_with_time(&selector.engine.context);
    for rival in evidence.iter_mut() {
        let other = selector.effects[rival.effect].as_ref();
        if rival.effect != own
            && let Some(behind) = most_nats(own_effect, other, rival.share, is_warming)
        {
            rival.nats = rival.nats.max(best - behind);
        }
    }
}

/// Nats by which an effect that explains `share` of what the cause does is behind it at most, however much is recorded: the
/// laws decide no further (docs/diagnosis.md, "Rivals"). None where nothing limits them. `is_warming` says that the
/// temperature follows the time.
///
/// The course of a drift is a matter of its law (a sensor lags behind the part that warms), so its kin counts as near while it
/// explains almost as much. An axis that wobbles and a cable that is routed over a joint differ by their laws' errors where
/// the axes intersect.
pub(crate) fn most_nats(
    own: &dyn Effect,
    other: &dyn Effect,
    share: f64,
    is_warming: bool,
) -> Option<f64> {
    let families = (own.spec().family, other.spec().family);
    let is_kin = families.0 == Family::Drift && other.is_kin_of(own) && other.name() != own.name();
    let unlike = (1.0 - share).max(0.0);
    if is_kin && is_warming && share > LOOK_ALIKE {
        return Some(BEHIND_NATS + LOOK_ALIKE_NATS * unlike / (1.0 - LOOK_ALIKE));
    }
    if is_kin && share > 1.0 - DRIFT_LAW {
        return Some(CONFUSABLE_NATS * unlike / DRIFT_LAW);
    }
    let are_look_alikes = matches!(
        families,
        (Family::Coupling, Family::Wobble) | (Family::Wobble, Family::Coupling)
    ) || families.0 == Family::Step
        && own.spec().follows == Follows::Run
        && matches!(families.1, Family::Tool | Family::Place);
    (are_look_alikes && share > COUPLED)
        .then(|| BEHIND_NATS + CONFUSABLE_NATS * unlike / (1.0 - COUPLED))
}

/// One entry for each name at a place.
fn merge(found: &mut Vec<Rival>) {
    let mut index = 0;
    while index < found.len() {
        let (name, joint) = (found[index].name, found[index].joint);
        let mut other = index + 1;
        while other < found.len() {
            if found[other].name == name && found[other].joint == joint {
                found[index].probability += found.remove(other).probability;
            } else {
                other += 1;
            }
        }
        index += 1;
    }
}

/// Whether the temperature is a settling function of time within the recording: what follows the one
/// then follows the other.
pub(crate) fn warms_with_time(context: &Context<'_>) -> bool {
    match (&context.warming_k, context.elapsed_s()) {
        (Some(warming_k), Some(elapsed_s)) => follows_time(warming_k, &elapsed_s),
        _ => false,
    }
}

/// The same of temperatures at times since the start of their runs.
pub(crate) fn follows_time(warming_k: &[f64], elapsed_s: &[f64]) -> bool {
    let whole = elapsed_s.iter().copied().fold(0.0, f64::max).max(1e-9);
    SETTLING_COURSES.iter().any(|share| {
        let settling = |time: &f64| 1.0 - (-time / (share * whole)).exp();
        let course: Vec<f64> = elapsed_s.iter().map(settling).collect();
        haptical_metrics::correlation(&course, warming_k).is_ok_and(|r| r.abs() > SAME_COURSE)
    })
}
