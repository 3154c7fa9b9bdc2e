//! Rivals: effects that explain as much in a cause's place, and how far behind they are.

use haptical_effects::{Context, Effect, Family, Follows};
use haptical_judge::{Backward, InPlace, Less, Other, Others, Without, probability};

use crate::engine::{Cause, Refit};
use crate::select::{Rival, Score, Selection, misfit};
use crate::thresholds::chance::CONFUSABLE_NATS;
use crate::thresholds::rivals::{
    BEHIND_NATS, COUPLED, DRIFT_LAW, EXCHANGES, LEAD, LISTED, LOOK_ALIKE, LOOK_ALIKE_NATS,
    NEAR_NATS, REFITTED, SAME_COURSE, SAME_GAIN, SETTLING_COURSES,
};
use crate::{DiagnosisError, Result};

/// Every cause's rivals, after causes that others have overtaken were exchanged.
pub(crate) fn settle(selection: &mut Selection<'_>) -> Result<Vec<Vec<Rival>>> {
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

/// The cause itself and its rivals, the best first.
pub(crate) fn rivals(selection: &mut Selection<'_>, cause: usize) -> Result<Vec<Rival>> {
    let whole = selection.refit.clone();
    let mut search = InPlaceOf {
        selection,
        scan: Vec::new(),
        gained: 0.0,
        explained: 0.0,
    };
    let without = search.without(&whole, cause)?;
    let found = haptical_judge::rivals(&mut search, &whole, cause, &without, 1.0)?;
    let effect = selection.selector.effects[whole.model.causes[cause].effect].as_ref();
    let own = Rival::new(effect, 1.0, 0.0);
    let others = found.into_iter().map(|rival| Rival {
        cause: rival.fit.cause,
        has_converged: rival.fit.has_converged,
        name: rival.name.0,
        joint: rival.name.1,
        share: rival.fit.share,
        nats_behind: rival.behind,
        probability: 0.0,
    });
    let others: Vec<Rival> = others.collect();
    let ahead = others.iter().map(|rival| rival.nats_behind);
    let ahead = ahead.fold(0.0, f64::min);
    Ok(listed(own, others, ahead))
}

/// An effect and its rivals with their probabilities; `ahead`: how far the first of all is ahead of the effect \[nats\], not above zero.
pub(crate) fn listed(
    own: Rival,
    others: impl IntoIterator<Item = Rival>,
    ahead: f64,
) -> Vec<Rival> {
    let mut list: Vec<Rival> = std::iter::once(own).chain(others).collect();
    let behind: Vec<f64> = list.iter().map(|rival| rival.nats_behind - ahead).collect();
    for (index, rival) in list.iter_mut().enumerate() {
        let others = behind.iter().enumerate();
        let others = others.filter(|(other, _)| *other != index);
        rival.nats_behind = behind[index];
        rival.probability = probability(others.map(|(_, other)| other - behind[index]));
    }
    list
}

/// Effects in the place of a cause.
struct InPlaceOf<'s, 'e> {
    selection: &'s mut Selection<'e>,
    /// Scan of what the other causes leave.
    scan: Vec<Score>,
    /// Squares that the cause explains by its refit, and those with which it counts.
    gained: f64,
    explained: f64,
}

/// What is known of an effect in a cause's place.
struct Known {
    /// Its fit, where it was refitted and ended at a minimum.
    cause: Option<Cause>,
    has_converged: bool,
    /// Share of what the cause explains.
    share: f64,
}

impl InPlaceOf<'_, '_> {
    /// Evidence of squares that an effect explains, the misfit allowed for \[nats\].
    fn nats(&self, explained: f64, of: &Score) -> f64 {
        self.selection.selector.criterion(&Score {
            score: explained / misfit(&self.selection.after),
            ..of.clone()
        })
    }
}

impl Backward for InPlaceOf<'_, '_> {
    type State = Refit;
    type Error = DiagnosisError;

    fn effects(&self, whole: &Refit) -> usize {
        whole.model.causes.len()
    }

    fn without(&mut self, whole: &Refit, index: usize) -> Less<Self> {
        let selection = &mut *self.selection;
        let selector = &mut selection.selector;
        let state = if whole.model.causes.len() == 1 {
            self.scan.clone_from(&selection.first_scan);
            selector.engine.start.clone()
        } else {
            let mut model = whole.model.clone();
            model.causes.remove(index);
            let refit = selector.engine.refit(selector.effects, &model)?;
            let system = selector.system_of(&refit);
            self.scan = selector.scan(&system, &refit.model);
            refit
        };
        self.gained = (selector.cost(&state) - selector.cost(whole)).max(1e-9);
        // the linear score of a rival counts where its refit falls short; so does that of the cause itself
        let cause = &whole.model.causes[index];
        let template = self.scan.iter().find(|score| score.effect == cause.effect);
        let template = template.cloned();
        let template = template.unwrap_or_else(|| Score::of_cause(cause, self.gained));
        self.explained = self.gained.max(template.score);
        let worth = self.nats(self.explained, &template);
        Ok(Without { state, worth })
    }
}

impl InPlace for InPlaceOf<'_, '_> {
    type Name = (&'static str, Option<usize>);
    type Fit = Known;

    fn in_place(&mut self, without: &Refit, whole: &Refit, index: usize) -> Others<Self> {
        let selector = &self.selection.selector;
        let own = selector.effects[whole.model.causes[index].effect].as_ref();
        let template = Score::of_cause(&whole.model.causes[index], self.explained);
        let of_own = self
            .scan
            .iter()
            .find(|score| score.effect == template.effect);
        let best = self.nats(self.explained, of_own.unwrap_or(&template));
        let others: Vec<&Score> = (self.scan.iter())
            .filter(|score| score.effect != template.effect)
            .take(LISTED)
            .collect();
        let is_near = |score: &&&Score| {
            best - self.nats(score.score, score) < NEAR_NATS
                || score.score > SAME_GAIN * self.gained
        };
        let near = others.iter().filter(is_near).copied().take(REFITTED);
        let near: Vec<&Score> = near.collect();
        let refits = haptical_parallel::map(near, |score| {
            let (fitted, cost) = selector.refit_with(&without.model, score, None)?;
            Ok((score.effect, fitted, cost))
        });
        let refits: Vec<(usize, Refit, f64)> = refits.into_iter().collect::<Result<_>>()?;
        let empty = selector.cost(without);
        let is_warming = warms_with_time(&selector.engine.context);
        let known = others.into_iter().map(|score| {
            let refit = refits.iter().find(|(effect, ..)| *effect == score.effect);
            // one that ended at no minimum may explain what its end still promises
            let explained = refit.map_or(score.score, |(_, fitted, cost)| {
                score.score.max(empty - cost + fitted.may_fall())
            });
            let has_converged = refit.is_none_or(|(_, fitted, _)| fitted.has_converged());
            let fit = refit.and_then(|(_, fitted, _)| fitted.model.causes.last().cloned());
            let other = selector.effects[score.effect].as_ref();
            let share = explained / self.gained;
            let nats = self.nats(explained, score);
            // effects whose difference is a matter of their laws are near
            let hedged = most_nats(own, other, share, is_warming).map(|behind| best - behind);
            Other {
                name: (other.name(), other.joint()),
                merit: hedged.map_or(nats, |hedged| nats.max(hedged)),
                fit: Known {
                    cause: fit.filter(|_| has_converged),
                    has_converged,
                    share,
                },
            }
        });
        let of_others = |other: &Other<Self::Name, Known>| other.name != (own.name(), own.joint());
        Ok(known.filter(of_others).collect())
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
