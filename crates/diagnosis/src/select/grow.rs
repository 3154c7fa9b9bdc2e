//! Causes that are picked one after the other, and taken out again where those after them made them superfluous (docs/diagnosis.md,
//! "Selection").

use haptical_effects::Family;
use haptical_judge::{
    Backward, Forward, Less, Needless, Proposal, Proposals, Ruled, Ruling, Without,
    without_needless,
};

use crate::engine::{Refit, SlowEnergy, System};
use crate::select::contend::RoughIsEnough;
use crate::select::{Grown, Refused, Score, Selector, Tried, excess};
use crate::thresholds::chance::MOST_CAUSES;
use crate::thresholds::fit::MOVED_FAR;
use crate::thresholds::selection::{
    DYNAMIC_RANGE, NEARLY_NOTHING, REFIT_OVER_SCAN, REFUSALS, STILL_MUCH,
};
use crate::{DiagnosisError, Result};

impl Selector<'_> {
    /// Picks without those that were refused.
    pub(super) fn grow(
        &mut self,
        before: &[SlowEnergy],
        refused: &mut Refused,
        may_stop: bool,
    ) -> Result<(Grown, Vec<Score>)> {
        let start = Grown {
            refit: self.engine.start.clone(),
            system: self.engine.system.clone(),
            after: before.to_vec(),
            explained: Vec::new(),
            provisional: Vec::new(),
        };
        let mut growth = Growth {
            selector: self,
            before,
            refused,
            may_stop,
            first_scan: Vec::new(),
            tried: Vec::new(),
        };
        let grown = haptical_judge::select(&mut growth, start)?;
        Ok((grown, growth.first_scan))
    }
}

struct Growth<'s, 'e> {
    selector: &'s mut Selector<'e>,
    before: &'s [SlowEnergy],
    refused: &'s mut Refused,
    /// Whether to end where the first cause has explained the gap and moved the base model far.
    may_stop: bool,
    first_scan: Vec<Score>,
    /// Refits with the causes so far.
    tried: Vec<Tried>,
}

impl Growth<'_, '_> {
    /// Whether the causes explain the gap, and moved the base model so far that all must be computed anew.
    fn has_moved_far(&self, grown: &Grown) -> bool {
        self.may_stop
            && !grown.refit.model.causes.is_empty()
            && self.is_far_and_explained(&grown.refit, &grown.after)
    }

    fn is_far_and_explained(&self, refit: &Refit, after: &[SlowEnergy]) -> bool {
        excess(after).0 < NEARLY_NOTHING * excess(self.before).0
            && self.selector.engine.moved(&refit.model.bare) >= MOVED_FAR
    }

    /// Whether a pick is none of what the laws of those before it may get wrong.
    fn is_beyond_laws(&self, grown: &Grown, score: &Score, after: &[SlowEnergy]) -> bool {
        let selector = &self.selector;
        let effect = selector.effects[score.effect].as_ref();
        let causes = &grown.refit.model.causes;
        causes.is_empty()
            || (score.score > DYNAMIC_RANGE * grown.explained.iter().sum::<f64>()
                && ((selector.is_quiet_there(effect, after)
                    && selector.is_elsewhere(score, causes))
                    || score.score > selector.law_errors(causes, &grown.explained, score)))
    }

    /// Whether what a pick leaves breaks no law of its effect.
    fn keeps_its_law(&self, score: &Score, is_first: bool, next: &Refit, system: &System) -> bool {
        let selector = &self.selector;
        let effect = selector.effects[score.effect].as_ref();
        let is_strict = !is_first || effect.spec().family == Family::Step;
        !is_strict
            || next.model.causes.last().is_none_or(|cause| {
                let broken = selector.broken_law(system, effect, cause, score.score);
                Selector::law_is_kept(effect, broken)
            })
    }
}

/// Whether an effect cannot be told from the rounding of what the causes so far explain, whatever its refit makes of it.
fn is_rounding(score: &Score, grown: &Grown) -> bool {
    REFIT_OVER_SCAN * score.score < DYNAMIC_RANGE * grown.explained.iter().sum::<f64>()
}

impl Forward for Growth<'_, '_> {
    type State = Grown;
    type Further = (Refit, Score);
    type Error = DiagnosisError;

    fn proposals(&mut self, grown: &Grown) -> Proposals<Self> {
        self.selector.engine.base.interrupt.check()?;
        if self.has_moved_far(grown) {
            return Ok(Vec::new());
        }
        let mut scan = self.selector.scan(&grown.system, &grown.refit.model);
        scan.retain(|score| !self.refused.shut.contains(&score.effect));
        if grown.refit.model.causes.is_empty() {
            self.first_scan.clone_from(&scan);
        }
        let is_full = grown.refit.model.causes.len() >= MOST_CAUSES;
        if is_full || self.refused.shut.len() > REFUSALS {
            return Ok(Vec::new());
        }
        if let Some(first) = scan.first().filter(|first| is_rounding(first, grown)) {
            if self.selector.is_more_than_chance(first, &grown.after)? {
                self.refused.best.get_or_insert(first.clone());
            }
            return Ok(Vec::new());
        }
        let mut tried = std::mem::take(&mut self.tried);
        let is_enough = |refit: &Refit| {
            let system = self.selector.system_of(refit);
            let after = system.slow_energy(&system.residual);
            self.is_far_and_explained(refit, &after)
        };
        let is_first = self.may_stop && grown.refit.model.causes.is_empty();
        let rough = is_first.then_some(&is_enough as &RoughIsEnough<'_>);
        let best = self.selector.best(grown, &scan, &mut tried, rough)?;
        self.tried = tried;
        self.refused.note(&self.tried, &scan);
        Ok(Proposal::of_best(best, |(_, score)| score.score))
    }

    fn rule(&mut self, grown: &Grown, best: Proposal<(Refit, Score)>) -> Ruled<Self> {
        let (next, score) = best.further;
        let system = self.selector.system_of(&next);
        let after = system.slow_energy(&system.residual);
        if !self.selector.is_more_than_chance(&score, &after)? {
            return Ok(Ruling::Ended);
        }
        let is_first = grown.refit.model.causes.is_empty();
        let is_enough = (self.selector).explains_enough(&score, &grown.after, &after);
        if !is_enough && is_first {
            self.refused.best.get_or_insert(score);
            return Ok(Ruling::Ended);
        }
        let is_beyond_laws = self.is_beyond_laws(grown, &score, &after);
        let keeps_its_law = self.keeps_its_law(&score, is_first, &next, &system);
        // while other effects are still to come a law cannot be judged
        let much_left = excess(&after).0 > STILL_MUCH * excess(self.before).0;
        if !is_enough || !is_beyond_laws || (!keeps_its_law && !much_left) {
            self.refused.add(score);
            return Ok(Ruling::Refused);
        }
        let mut with = grown.with(next, system, after, &score);
        if !keeps_its_law {
            with.provisional.push(score);
        }
        self.tried.clear();
        Ok(Ruling::Taken(with))
    }
}

impl Selector<'_> {
    /// Takes out, one after the other, causes that explain no more than chance when all others are in the model or the
    /// others' laws; what is left is credited with what it explains then.
    pub(crate) fn trim(&self, grown: &mut Grown) -> Result<()> {
        let causes = grown.refit.model.causes.len();
        let mut trim = Trim {
            cost: self.cost(&grown.refit),
            after: grown.after.clone(),
            selector: self,
            causes,
        };
        let kept = without_needless(&mut trim, grown.refit.clone(), 1)?;
        if let Some(worth) = kept.worth {
            grown.explained = worth;
        }
        if kept.state.model.causes.len() < causes {
            grown.refit = kept.state;
            grown.system = self.system_of(&grown.refit);
            grown.after = grown.system.slow_energy(&grown.system.residual);
        }
        Ok(())
    }

    /// Whether a cause explains no more than chance or than what the others' laws may get wrong.
    fn is_superfluous(
        &self,
        (refit, after): (&Refit, &[SlowEnergy]),
        index: usize,
        explained: &[f64],
    ) -> Result<bool> {
        let causes = &refit.model.causes;
        let pick = Score::of_cause(&causes[index], explained[index]);
        let mut others = causes.clone();
        others.remove(index);
        let mut of_others = explained.to_vec();
        of_others.remove(index);
        let within_laws = !self.is_elsewhere(&pick, &others)
            && pick.score <= self.law_errors(&others, &of_others, &pick);
        Ok(within_laws || !self.is_more_than_chance(&pick, after)?)
    }
}

/// Causes that are taken out.
struct Trim<'s, 'e> {
    selector: &'s Selector<'e>,
    /// Of the model with so many causes: its cost, and the slow energy that it leaves.
    causes: usize,
    cost: f64,
    after: Vec<SlowEnergy>,
}

impl Backward for Trim<'_, '_> {
    type State = Refit;
    type Error = DiagnosisError;

    fn effects(&self, refit: &Refit) -> usize {
        refit.model.causes.len()
    }

    fn without(&mut self, refit: &Refit, index: usize) -> Less<Self> {
        let selector = self.selector;
        if refit.model.causes.len() != self.causes {
            let system = selector.system_of(refit);
            self.after = system.slow_energy(&system.residual);
            self.cost = selector.cost(refit);
            self.causes = refit.model.causes.len();
        }
        let mut model = refit.model.clone();
        model.causes.remove(index);
        let state = selector.engine.refit(selector.effects, &model)?;
        Ok(Without {
            worth: (selector.cost(&state) - self.cost).max(0.0),
            state,
        })
    }
}

impl Needless for Trim<'_, '_> {
    fn is_needless(&mut self, refit: &Refit, index: usize, all: &[Without<Refit>]) -> Result<bool> {
        // where the others found no minimum, nobody knows what they leave
        if !all[index].state.has_converged() {
            return Ok(false);
        }
        let explained: Vec<f64> = all.iter().map(|without| without.worth).collect();
        (self.selector).is_superfluous((refit, &self.after), index, &explained)
    }
}
