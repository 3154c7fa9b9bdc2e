//! Causes that account for a part of a gap: what they predict on rows that their fit did not see, and whether
//! their laws hold there (docs/diagnosis.md, "Partial causes").

mod cables;
mod hypotheses;
mod support;

use haptical_judge::{Forward, Proposal, Proposals, Ruled, Ruling};

use self::hypotheses::Hypothesis;
use crate::engine::{Model, Refit, Segments, System, Unseen};
use crate::select::{Candidate, Rival, Selection, Selector};
use crate::thresholds::partial::{
    BEYOND_CHANCE_SD, LEAST_FURTHER_SHARE, LEAST_SHARE, MOST_HYPOTHESES,
};
use crate::{DiagnosisError, Result};

/// What causes that leave a rest are supported by.
#[derive(Debug)]
pub(crate) struct Partial {
    /// Share of the squares beyond noise that they take off unseen rows.
    pub(crate) share: f64,
    /// Of each cause, itself first: what else would have predicted the unseen rows.
    pub(crate) rivals: Vec<Vec<Rival>>,
    /// Whether they are what cables do: play and loop are two names of one thing there.
    pub(crate) is_of_cables: bool,
}

impl Selection<'_> {
    /// Takes up what unseen rows support, from no cause at all, where all that was found is not enough; none where nothing is
    /// supported, and then nothing is changed.
    pub(crate) fn take_partial(&mut self) -> Result<Option<Partial>> {
        let selector = &self.selector;
        let engine = selector.engine;
        if engine.base.anchor.is_some() {
            return Ok(None);
        }
        let segments = Segments::new(&engine.context, &engine.system);
        let alone = segments.unseen(&engine.system);
        let nothing = Taken {
            refit: engine.start.clone(),
            system: engine.system.clone(),
            unseen: alone.clone(),
            rivals: Vec::new(),
            wrong: 0.0,
        };
        let noise = engine.system.layout.count() as f64;
        let gap = (alone.sum() - noise).max(0.0);
        let mut partly = Partly {
            selector: &mut self.selector,
            segments: &segments,
            energies: (gap, alone.sum()),
            hypotheses: 0,
        };
        let taken = haptical_judge::select(&mut partly, nothing)?;
        if taken.refit.model.causes.is_empty() {
            return Ok(None);
        }
        let share = taken.unseen.closed_of(&alone, noise);
        self.explained = self.selector.explained_alone(&taken.refit.model);
        self.after = taken.system.slow_energy(&taken.system.residual);
        (self.refit, self.system) = (taken.refit, taken.system);
        let rivals = taken.rivals;
        Ok(Some(Partial {
            share,
            rivals,
            is_of_cables: false,
        }))
    }
}

/// Hypotheses that are taken up one after the other.
struct Partly<'s, 'e> {
    selector: &'s mut Selector<'e>,
    segments: &'s Segments,
    /// Squares beyond noise that the base model leaves of unseen rows, and all that it leaves.
    energies: (f64, f64),
    hypotheses: usize,
}

type Found = (Hypothesis, Vec<Vec<Rival>>);

impl Forward for Partly<'_, '_> {
    type State = Taken;
    type Further = Found;
    type Error = DiagnosisError;

    fn proposals(&mut self, taken: &Taken) -> Proposals<Self> {
        if self.hypotheses >= MOST_HYPOTHESES {
            return Ok(Vec::new());
        }
        self.hypotheses += 1;
        let causes = &taken.refit.model.causes;
        let scan = self.selector.scan(&taken.system, &taken.refit.model);
        let found = (self.selector).hypotheses(&scan, causes, &taken.system, self.segments);
        let best = simplest_of_the_best(&found).map(|best| Proposal {
            merit: best.unseen.gain_on(&taken.unseen).sum,
            further: (
                best.clone(),
                self.selector.rivals_of(best, &found, &taken.unseen),
            ),
        });
        Ok(best.into_iter().collect())
    }

    /// The hypothesis with all before it, where unseen rows support it.
    fn rule(&mut self, taken: &Taken, best: Proposal<Found>) -> Ruled<Self> {
        let (selector, segments) = (&*self.selector, self.segments);
        let (hypothesis, rivals) = best.further;
        let mut model = taken.refit.model.clone();
        model.causes.extend(hypothesis.causes);
        let refit = selector.engine.refit(selector.effects, &model)?;
        if !refit.has_converged() || !selector.is_possible(&refit.model) {
            return Ok(Ruling::Ended);
        }
        let system = selector.system_of(&refit);
        let unseen = segments.unseen(&system);
        let gain = unseen.gain_on(&taken.unseen);
        let (gap, alone) = self.energies;
        let least = match taken.refit.model.causes.is_empty() {
            true => LEAST_SHARE * gap,
            false => LEAST_FURTHER_SHARE * (gap - (alone - taken.unseen.sum())),
        };
        if gain.deviations() < BEYOND_CHANCE_SD || gain.sum < least {
            return Ok(Ruling::Ended);
        }
        let first = taken.refit.model.causes.len();
        let causes = &refit.model.causes[first..];
        let with = With {
            system: &system,
            unseen: &unseen,
            gain: gain.sum,
        };
        if !selector.laws_hold(causes, taken, with, segments)
            || selector.lies_elsewhere(causes, taken, with, segments)
        {
            return Ok(Ruling::Ended);
        }
        Ok(Ruling::Taken(Taken {
            wrong: taken.wrong + selector.wrong_by_law(causes, gain.sum),
            rivals: [taken.rivals.clone(), rivals].concat(),
            refit,
            system,
            unseen,
        }))
    }
}

impl Selector<'_> {
    /// What each cause explains beside the others.
    fn explained_alone(&self, model: &Model) -> Vec<f64> {
        let signals =
            |index: usize| model.causes[index].derivative(self.effects, &self.engine.context);
        let alone = |index: usize| {
            let mut others = self.engine.system.clone();
            let causes = (0..model.causes.len()).filter(|other| *other != index);
            causes
                .flat_map(signals)
                .for_each(|own| others.project_out(&own));
            let own = Candidate::of_signals(&others, &signals(index), usize::MAX, 0.0);
            own.score(&others).score
        };
        (0..model.causes.len()).map(alone).collect()
    }
}

/// The hypothesis with the fewest numbers of those that the best one does not beat by more than the scatter of the
/// segments (the rule of one standard error; Breiman et al. 1984, 3.4.3).
fn simplest_of_the_best(found: &[Hypothesis]) -> Option<&Hypothesis> {
    let by_rest = |a: &&Hypothesis, b: &&Hypothesis| a.unseen.sum().total_cmp(&b.unseen.sum());
    let best = found.iter().min_by(by_rest)?;
    let is_as_good = |other: &&Hypothesis| best.unseen.gain_on(&other.unseen).deviations() < 1.0;
    let as_good = found.iter().filter(is_as_good);
    as_good.min_by(|a, b| a.numbers().cmp(&b.numbers()).then(by_rest(a, b)))
}

/// Hypotheses taken up so far.
pub(super) struct Taken {
    pub(super) refit: Refit,
    pub(super) system: System,
    pub(super) unseen: Unseen,
    pub(super) rivals: Vec<Vec<Rival>>,
    /// Squares that their laws may get wrong.
    pub(super) wrong: f64,
}

/// A hypothesis in the model, with what it takes off unseen rows.
#[derive(Clone, Copy)]
pub(super) struct With<'w> {
    pub(super) system: &'w System,
    pub(super) unseen: &'w Unseen,
    pub(super) gain: f64,
}
