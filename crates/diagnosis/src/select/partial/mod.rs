//! Causes that account for a part of a gap: what they predict on rows that their fit did not see, and whether
//! their laws hold there (docs/diagnosis.md, "Partial causes").

mod cables;
mod hypotheses;
mod replaceable;
mod support;
mod taken;

use crate::DiagnosisError;
use crate::engine::model::Model;
use crate::engine::segments::Segments;
use crate::select::partial::hypotheses::Hypothesis;
use crate::select::partial::taken::{Taken, With};
use crate::select::rival::Rival;
use crate::select::scan::{Candidate, Score};
use crate::select::{Selection, Selector};
use crate::thresholds::partial::{
    BEYOND_CHANCE_SD, LEAST_FURTHER_SHARE, LEAST_SHARE, MOST_HYPOTHESES,
};

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
    pub(crate) fn take_partial(&mut self) -> Result<Option<Partial>, DiagnosisError> {
        let selector = &self.selector;
        let engine = selector.engine;
        if engine.base.anchor.is_some() {
            return Ok(None);
        }
        let segments = Segments::new(&engine.context, &engine.system);
        let alone = segments.unseen(&engine.system);
        let mut taken = Taken {
            refit: engine.start.clone(),
            system: engine.system.clone(),
            unseen: alone.clone(),
            rivals: Vec::new(),
            wrong: 0.0,
        };
        let noise = engine.system.layout.count() as f64;
        let gap = (alone.sum() - noise).max(0.0);
        for _ in 0..MOST_HYPOTHESES {
            let scan = self.selector.scan(&taken.system, &taken.refit.model);
            let Some(next) = self
                .selector
                .next(&taken, &scan, &segments, (gap, alone.sum()))?
            else {
                break;
            };
            taken = next;
        }
        if taken.refit.model.causes.is_empty() {
            return Ok(None);
        }
        let share = (taken.unseen.gain_on(&alone).sum / gap).clamp(0.0, 1.0);
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

impl Selector<'_> {
    /// The next hypothesis with all before it, where unseen rows support it.
    fn next(
        &self,
        taken: &Taken,
        scan: &[Score],
        segments: &Segments,
        (gap, alone): (f64, f64),
    ) -> Result<Option<Taken>, DiagnosisError> {
        let found = self.hypotheses(scan, &taken.refit.model.causes, &taken.system, segments);
        let Some(best) = simplest_of_the_best(&found) else {
            return Ok(None);
        };
        let mut model = taken.refit.model.clone();
        model.causes.extend(best.causes.iter().cloned());
        let refit = self.engine.refit(self.effects, &model)?;
        if !refit.has_converged() || !self.is_possible(&refit.model) {
            return Ok(None);
        }
        let system = self.system_of(&refit);
        let unseen = segments.unseen(&system);
        let gain = unseen.gain_on(&taken.unseen);
        let least = match taken.refit.model.causes.is_empty() {
            true => LEAST_SHARE * gap,
            false => LEAST_FURTHER_SHARE * (gap - (alone - taken.unseen.sum())),
        };
        if gain.deviations() < BEYOND_CHANCE_SD || gain.sum < least {
            return Ok(None);
        }
        let first = taken.refit.model.causes.len();
        let causes = &refit.model.causes[first..];
        let with = With {
            system: &system,
            unseen: &unseen,
            gain: gain.sum,
        };
        if !self.laws_hold(causes, taken, with, segments)
            || self.lies_elsewhere(causes, taken, with, segments)
        {
            return Ok(None);
        }
        let wrong = taken.wrong + self.wrong_by_law(causes, gain.sum);
        let mut rivals = taken.rivals.clone();
        rivals.extend(self.rivals_of(best, &found, &taken.unseen));
        Ok(Some(Taken {
            refit,
            system,
            unseen,
            rivals,
            wrong,
        }))
    }

    /// What each cause explains beside the others.
    fn explained_alone(&self, model: &Model) -> Vec<f64> {
        let context = &self.engine.context;
        let columns = |index: usize| -> Vec<_> {
            let signals = model.causes[index].derivative(self.effects, context);
            let system = &self.engine.system;
            signals.iter().map(|signal| system.column(signal)).collect()
        };
        (0..model.causes.len())
            .map(|index| {
                let mut others = self.engine.system.clone();
                for other in (0..model.causes.len()).filter(|other| *other != index) {
                    for column in columns(other) {
                        others.project_out(&column);
                    }
                }
                let own = Candidate::of_columns(&others, columns(index), usize::MAX, 0.0);
                own.score(&others).score
            })
            .collect()
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
