//! Stepwise selection of causes: scan, refit of the best, and a stop where chance or misfit begins.

mod chance;
mod contend;
mod events;
mod generic;
mod grow;
mod laws;
mod partial;
mod ranking;
mod scan;
mod split;
mod springs;

use haptical_effects::Effect;

use crate::Result;
use crate::engine::{Cause, Engine, Refit, SlowEnergy, System};
use crate::thresholds::rivals::REPLACED_COST;
use crate::thresholds::selection::REFUSALS;

pub(crate) use self::chance::{excess, family_wise_p, misfit, worst_excess};
pub(crate) use self::contend::Tried;
pub(crate) use self::events::{Instants, StepPlace};
pub(crate) use self::generic::{
    Covariate, Place, free_function, hats, inner_range, own_covariates, score, sides, varying_gain,
};
pub(crate) use self::partial::Partial;
pub(crate) use self::scan::{Candidate, Rival, Score, candidates};
pub(crate) use self::split::{is_displacement, split};

/// The causes that were found, and what they leave.
#[derive(Debug)]
pub(crate) struct Selection<'e> {
    pub(crate) selector: Selector<'e>,
    pub(crate) refit: Refit,
    /// Slow energy per stream of the base model, and of the causes' model.
    pub(crate) before: Vec<SlowEnergy>,
    pub(crate) after: Vec<SlowEnergy>,
    /// Explained squared residual of each cause when it was added.
    pub(crate) explained: Vec<f64>,
    /// System with the causes projected out.
    pub(crate) system: System,
    /// Scan of the base model's residuals, best first.
    pub(crate) first_scan: Vec<Score>,
    /// The best pick that was refused, if any.
    pub(crate) refused: Option<Score>,
    /// Contenders whose refits ended at no minimum, by effect, with what the scan gives them.
    pub(crate) unconverged: Vec<Score>,
}

/// Causes picked so far.
#[derive(Debug, Clone)]
pub(crate) struct Grown {
    pub(crate) refit: Refit,
    pub(crate) system: System,
    pub(crate) after: Vec<SlowEnergy>,
    pub(crate) explained: Vec<f64>,
    /// Picks whose law is judged when those that follow are in.
    provisional: Vec<Score>,
}

impl Grown {
    /// The causes with a further one, as they were refitted.
    fn with(&self, refit: Refit, system: System, after: Vec<SlowEnergy>, score: &Score) -> Self {
        Self {
            refit,
            system,
            after,
            explained: [self.explained.as_slice(), &[score.score]].concat(),
            provisional: self.provisional.clone(),
        }
    }
}

/// Picks that were not taken.
#[derive(Debug, Default)]
pub(crate) struct Refused {
    best: Option<Score>,
    /// Their effects, which are not tried again.
    shut: Vec<usize>,
    /// Contenders whose refits ended at no minimum.
    unconverged: Vec<Score>,
}

impl Refused {
    fn add(&mut self, score: Score) {
        self.shut.push(score.effect);
        self.best.get_or_insert(score);
    }
}

/// Scans and picks.
#[derive(Debug)]
pub(crate) struct Selector<'e> {
    pub(crate) engine: &'e Engine<'e>,
    pub(crate) effects: &'e [Box<dyn Effect>],
    /// Effects that the recording can test.
    pub(crate) tested: &'e [usize],
    candidates: Vec<Candidate>,
}

impl<'e> Selector<'e> {
    pub(crate) fn new(
        engine: &'e Engine<'e>,
        effects: &'e [Box<dyn Effect>],
        tested: &'e [usize],
    ) -> Self {
        Self {
            engine,
            effects,
            tested,
            candidates: candidates(&engine.system, &engine.context, effects, tested),
        }
    }

    /// Picks causes until what is left is chance or no effect of the catalogue; or, with `may_stop`, until
    /// the first has explained the gap and moved the base model so far that all must be computed anew.
    pub(crate) fn select(mut self, may_stop: bool) -> Result<Selection<'e>> {
        let before = self.engine.system.slow_energy(&self.engine.system.residual);
        let mut refused = Refused::default();
        loop {
            let (mut grown, first_scan) = self.grow(&before, &mut refused, may_stop)?;
            self.springs(&mut grown, refused.best.as_ref())?;
            self.trim(&mut grown)?;
            let broken = self.broken_in_the_end(&grown);
            match broken.filter(|_| refused.shut.len() <= REFUSALS) {
                Some(score) => refused.add(score),
                None => {
                    return Ok(Selection {
                        selector: self,
                        refit: grown.refit,
                        before,
                        after: grown.after,
                        explained: grown.explained,
                        system: grown.system,
                        first_scan,
                        refused: refused.best,
                        unconverged: refused.unconverged,
                    });
                }
            }
        }
    }

    /// The first cause that was taken up provisionally and whose law is broken with all others in the model too.
    fn broken_in_the_end(&self, grown: &Grown) -> Option<Score> {
        let causes = grown.refit.model.causes.iter().zip(&grown.explained);
        grown.provisional.iter().find_map(|score| {
            let (cause, explained) = causes
                .clone()
                .find(|(cause, _)| cause.effect == score.effect)?;
            let effect = self.effects[cause.effect].as_ref();
            let broken = self.broken_law(&grown.system, effect, cause, *explained);
            (!Self::law_is_kept(effect, broken)).then(|| score.clone())
        })
    }

    /// Every effect but events at every shape.
    pub(crate) fn base_candidates(&self) -> impl Iterator<Item = &Candidate> {
        self.candidates.iter()
    }

    /// The system of a model: its causes projected out, its residuals in place.
    pub(crate) fn system_of(&self, refit: &Refit) -> System {
        let mut system = self.engine.system.clone();
        for cause in &refit.model.causes {
            for signal in cause.derivative(self.effects, &self.engine.context) {
                system.project_out(&signal);
            }
        }
        system.set_residual(&refit.residual);
        system
    }
}

impl<'e> Selection<'e> {
    /// The base model, and the recording that it was fitted to.
    pub(crate) fn engine(&self) -> &'e Engine<'e> {
        self.selector.engine
    }

    pub(crate) fn causes(&self) -> &[Cause] {
        &self.refit.model.causes
    }

    /// Whitened columns of the causes' amplitudes.
    pub(crate) fn columns_of_causes(&self) -> Vec<Vec<f64>> {
        let engine = self.engine();
        let causes = self.causes().iter();
        let signals =
            causes.flat_map(|cause| cause.derivative(self.selector.effects, &engine.context));
        let blocks = &engine.whole.blocks;
        signals.map(|signal| blocks.dense(&signal)).collect()
    }

    pub(crate) fn effect(&self, cause: &Cause) -> &'e dyn Effect {
        self.selector.effects[cause.effect].as_ref()
    }

    /// Takes another effect in a cause's place, if that refits better.
    pub(crate) fn replace(&mut self, cause: usize, by: Cause) -> Result<bool> {
        let selector = &self.selector;
        let mut model = self.refit.model.clone();
        model.causes[cause] = by;
        let fitted = selector.engine.refit(selector.effects, &model)?;
        if !fitted.has_converged()
            || !selector.is_possible(&fitted.model)
            || selector.cost(&fitted) > selector.cost(&self.refit) + REPLACED_COST
        {
            return Ok(false);
        }
        self.system = selector.system_of(&fitted);
        self.after = self.system.slow_energy(&self.system.residual);
        self.refit = fitted;
        Ok(true)
    }
}
