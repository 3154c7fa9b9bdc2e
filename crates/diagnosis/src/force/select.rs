//! Stepwise selection of effects on the torques, with the rivals of each.

use haptical_effects::transmission::INPUT_DRUM_HARMONIC;
use haptical_judge::{
    Backward, Forward, InPlace, Less, Needless, Other, Others, Proposal, Proposals, Ruled, Ruling,
    Without, probability, rivals, without_needless,
};
use haptical_linalg::golden_section;

use super::Means;
use super::base::Base;
use super::effects::{Effects, is_harmonic, is_scale, is_sensor_loop};
use crate::engine::SlowEnergy;
use crate::select::{Candidate, Score, excess, family_wise_p, misfit};
use crate::thresholds::chance::CONFUSABLE_NATS;
use crate::thresholds::torque::{
    FAMILY_WISE_P, LEAST_LOOP, LEAST_RETAINED, LEAST_SHARE_OF_NOISE, MOST_NAMES, MOST_ORDERS,
    MOST_RIPPLES, SHAPE_STEP, SHARE_OF_REST, TRANSITION_REACH, TRANSITION_STEPS,
};
use crate::{DiagnosisError, Result};

/// A chosen effect.
#[derive(Debug, Clone)]
pub(super) struct Pick {
    /// Position in the catalogue.
    pub(super) effect: usize,
    pub(super) shape: f64,
    /// The last is the derivative with respect to the logarithm of a continuous shape.
    pub(super) columns: Vec<Vec<f64>>,
    /// Place of the first of them in the model with all picks.
    pub(super) first: usize,
    /// Chi-square that it saves with the others kept.
    pub(super) score: f64,
    pub(super) probability: f64,
    /// Other names that would do nearly as well.
    pub(super) rivals: Vec<&'static str>,
}

impl Pick {
    fn of(score: &Score, columns: Vec<Vec<f64>>) -> Self {
        Self {
            effect: score.effect,
            shape: score.shape,
            columns,
            first: 0,
            score: score.score,
            probability: 1.0,
            rivals: Vec::new(),
        }
    }
}

#[derive(Debug, Clone, Default)]
pub(super) struct Selection {
    pub(super) picks: Vec<Pick>,
    /// Slow energy per channel of the base model, and of the picks' model.
    pub(super) before: Vec<SlowEnergy>,
    pub(super) after: Vec<SlowEnergy>,
    /// Block means that these two models leave.
    pub(super) rest_before: Means,
    pub(super) rest_after: Means,
}

impl Effects<'_> {
    pub(super) fn energy(&self, base: &Base) -> Vec<SlowEnergy> {
        base.energy(self.along.recorded.free_directions())
    }

    /// An arm that moves by itself has friction in every joint.
    fn most_names(&self) -> usize {
        let recorded = &self.along.recorded;
        match recorded.moves_by_itself() {
            true => MOST_NAMES.max(recorded.channels.len()),
            false => MOST_NAMES,
        }
    }

    /// Chooses effects one after the other; they become base columns of `base`.
    pub(super) fn select(&self, base: &mut Base) -> Result<Selection> {
        let mut search = Search {
            candidates: self.candidates(base),
            effects: self,
        };
        let mut start = Chosen {
            base: base.clone(),
            ripples: Vec::new(),
            selection: Selection::default(),
            gone: None,
        };
        start.begin(self);
        let mut chosen = haptical_judge::select(&mut search, start)?;
        chosen.selection.picks = search.compared(&chosen)?;
        *base = chosen.base;
        chosen.selection.rest_after = base.rest();
        Ok(chosen.selection)
    }

    /// Whether an effect is in the model already, at its place; of the harmonics of a motor's angle some may be.
    fn is_taken(&self, score: &Score, chosen: &Chosen) -> bool {
        let effect = self.effect(score.effect);
        let at_place = |pick: &&Pick| {
            let other = self.effect(pick.effect);
            other.name() == effect.name() && other.joint() == effect.joint()
        };
        let mut picked = chosen.selection.picks.iter().filter(at_place);
        if !is_harmonic(effect) {
            return picked.next().is_some();
        }
        let wanted = (score.effect, score.shape);
        picked.clone().count() >= MOST_ORDERS
            || (picked.chain(&chosen.ripples)).any(|pick| (pick.effect, pick.shape) == wanted)
    }

    /// Bayes' criterion: the score less what as many free numbers explain of nothing.
    pub(super) fn merit(&self, score: &Score) -> f64 {
        let shapes = self.shapes(score.effect).len() as f64;
        score.score - score.rank as f64 * self.along.recorded.rows().ln() - 2.0 * shapes.ln()
    }

    fn is_found(&self, score: &Score, tested: usize) -> Result<bool> {
        let p = family_wise_p(score, 1.0, tested as f64)?;
        let is_large = is_scale(self.effect(score.effect))
            || score.score >= LEAST_SHARE_OF_NOISE * self.along.recorded.rows();
        Ok(p < FAMILY_WISE_P && is_large && score.retained > LEAST_RETAINED)
    }

    /// Whether a hysteresis shows as a loop: a state that hardly reverses is a bias, one that hardly saturates a gain.
    /// These are asked whether or not the catalogue has them.
    fn is_a_loop(&self, base: &Base, score: &Score) -> bool {
        if !is_sensor_loop(self.effect(score.effect)) {
            return true;
        }
        let mut extended = base.clone();
        extended.adopt(&self.bias_and_gain(base));
        let columns = self.columns(base, score.effect, score.shape);
        let left = extended.score(&columns, score.effect, score.shape);
        left.score >= LEAST_LOOP * score.score
    }

    /// Adds an effect to the model after a search for its shape.
    pub(super) fn taken(&self, base: &mut Base, score: &Score) -> Pick {
        let (shape, columns) = self.refined(base, score);
        let first = base.regression.len();
        base.adopt(&columns);
        if is_scale(self.effect(score.effect)) {
            self.along.settle(base);
        }
        Pick {
            shape,
            first,
            ..Pick::of(score, columns)
        }
    }

    /// The shape of an effect searched between those of the grid (golden section), and its columns with the
    /// derivative by the shape's logarithm.
    fn refined(&self, base: &Base, pick: &Score) -> (f64, Vec<Vec<f64>>) {
        let columns = |shape: f64| self.columns(base, pick.effect, shape);
        if !self.effect(pick.effect).spec().shape.is_continuous() {
            return (pick.shape, columns(pick.shape));
        }
        let placed = |log: f64| pick.shape * log.exp();
        let score = |shape: f64| base.score(&columns(shape), pick.effect, shape);
        let at = |log: f64| score(placed(log)).score;
        let reach = TRANSITION_REACH.ln();
        let best = golden_section([-reach, reach], TRANSITION_STEPS, at);
        let shape = placed(best);
        let mut found = columns(shape);
        let amplitudes = score(shape).amplitudes;
        let mut slope = vec![0.0; base.regression.reading().len()];
        for side in [1.0, -1.0] {
            let shifted = columns(placed(best + side * SHAPE_STEP));
            for (column, amplitude) in shifted.iter().zip(&amplitudes) {
                let factor = side * amplitude / (2.0 * SHAPE_STEP);
                let entries = slope.iter_mut().zip(column);
                entries.for_each(|(sum, value)| *sum += factor * value);
            }
        }
        found.push(slope);
        (shape, found)
    }
}

/// Effects chosen so far, as base columns of a model.
#[derive(Debug, Clone)]
struct Chosen {
    base: Base,
    /// Harmonics of motors' angles that were taken instead of cogging. They are no gap of the torques.
    ripples: Vec<Pick>,
    selection: Selection,
    /// Score of the effect that was taken out.
    gone: Option<Score>,
}

impl Chosen {
    /// Takes what the model leaves now as what picks are to explain.
    fn begin(&mut self, effects: &Effects<'_>) {
        self.selection.rest_before = self.base.rest();
        self.selection.before = effects.energy(&self.base);
        self.selection.after.clone_from(&self.selection.before);
    }
}

/// The search of effects on the torques.
struct Search<'s, 'a> {
    effects: &'s Effects<'a>,
    candidates: Vec<Candidate>,
}

impl Forward for Search<'_, '_> {
    type State = Chosen;
    type Further = Score;
    type Error = DiagnosisError;

    fn proposals(&mut self, chosen: &Chosen) -> Proposals<Self> {
        let effects = self.effects;
        if chosen.selection.picks.len() >= effects.most_names() {
            return Ok(Vec::new());
        }
        let mut scores = effects.scores(&chosen.base, &mut self.candidates);
        scores.retain(|score| !effects.is_taken(score, chosen));
        let proposal = |further: Score| Proposal {
            merit: effects.merit(&further),
            further,
        };
        Ok(scores.into_iter().map(proposal).collect())
    }

    fn rule(&mut self, chosen: &Chosen, best: Proposal<Score>) -> Ruled<Self> {
        let (effects, score) = (self.effects, best.further);
        let effect = effects.effect(score.effect);
        let is_fresh = is_scale(effect) || chosen.selection.picks.is_empty();
        let rest = excess(&chosen.selection.after).0.max(0.0);
        let is_part = is_fresh || is_harmonic(effect) || score.score >= SHARE_OF_REST * rest;
        if !effects.is_found(&score, self.candidates.len())?
            || !is_part
            || !effects.is_a_loop(&chosen.base, &score)
        {
            return Ok(Ruling::Ended);
        }
        let mut next = chosen.clone();
        if is_harmonic(effect) && chosen.ripples.len() < MOST_RIPPLES {
            let columns = effects.ripple(&chosen.base, score.effect, score.shape);
            let rival = (chosen.base).score(&columns, score.effect, score.shape);
            if rival.rank > 0 && effects.merit(&rival) > best.merit {
                next.base.adopt(&columns);
                next.ripples.push(Pick::of(&rival, columns));
                if next.selection.picks.is_empty() {
                    // what an angle's error adds is no gap of the torques
                    next.begin(effects);
                }
                return Ok(Ruling::Taken(next));
            }
        }
        next.selection
            .picks
            .push(effects.taken(&mut next.base, &score));
        next.selection.after = effects.energy(&next.base);
        Ok(Ruling::Taken(next))
    }
}

impl Backward for Search<'_, '_> {
    type State = Chosen;
    type Error = DiagnosisError;

    fn effects(&self, chosen: &Chosen) -> usize {
        chosen.selection.picks.len()
    }

    fn without(&mut self, chosen: &Chosen, index: usize) -> Less<Self> {
        let mut less = chosen.clone();
        let gone = less.selection.picks.remove(index);
        let base = &mut less.base;
        base.regression.truncate(base.scales.end);
        let others = less.ripples.iter().chain(&less.selection.picks);
        others.for_each(|pick| base.adopt(&pick.columns));
        let score = base.score(&gone.columns, gone.effect, gone.shape);
        let worth = self.effects.merit(&score);
        less.gone = Some(score);
        Ok(Without { state: less, worth })
    }
}

impl Needless for Search<'_, '_> {
    /// One of another shape of an effect that is in the model makes up for that one's misfit.
    fn is_needless(
        &mut self,
        chosen: &Chosen,
        index: usize,
        all: &[Without<Chosen>],
    ) -> Result<bool> {
        let without = &all[index];
        let Some(score) = &without.state.gone else {
            return Ok(false);
        };
        if !self.effects.is_found(score, self.candidates.len())? {
            return Ok(true);
        }
        let rivals = rivals(self, chosen, index, without, dispersion(chosen))?;
        let is_likely = probability(rivals.iter().map(|rival| rival.behind)) > 0.5;
        Ok(index > 0 && !is_likely)
    }
}

impl InPlace for Search<'_, '_> {
    type Name = (&'static str, Option<usize>);
    type Fit = ();

    fn in_place(&mut self, without: &Chosen, whole: &Chosen, index: usize) -> Others<Self> {
        let effects = self.effects;
        let name = |index: usize| {
            let effect = effects.effect(index);
            (effect.name(), effect.joint())
        };
        let pick = &whole.selection.picks[index];
        let other = |name, merit| Other {
            name,
            merit,
            fit: (),
        };
        let mut scores = effects.scores(&without.base, &mut self.candidates);
        scores.retain(|score| {
            name(score.effect) != name(pick.effect) && score.retained >= LEAST_RETAINED
        });
        let others = scores.iter();
        let others = others.map(|score| other(name(score.effect), effects.merit(score)));
        let mut others: Vec<_> = others.collect();
        let effect = effects.effect(pick.effect);
        if is_harmonic(effect) {
            let columns = effects.ripple(&without.base, pick.effect, pick.shape);
            let ripple = (without.base).score(&columns, pick.effect, pick.shape);
            let name = (INPUT_DRUM_HARMONIC.name, effect.joint());
            others.push(other(name, effects.merit(&ripple)));
        }
        Ok(others)
    }
}

/// Merits are squares, and two of them a nat; the more is left, the less they weigh.
fn dispersion(chosen: &Chosen) -> f64 {
    2.0 * misfit(&chosen.selection.after)
}

impl Search<'_, '_> {
    /// The picks that are needed, with what each saves with the others kept, and who would do as well in its place.
    fn compared(&mut self, chosen: &Chosen) -> Result<Vec<Pick>> {
        let kept = without_needless(self, chosen.clone(), 0)?.state;
        let mut picks = kept.selection.picks.clone();
        for (index, pick) in picks.iter_mut().enumerate() {
            let without = self.without(&kept, index)?;
            let found = rivals(self, &kept, index, &without, dispersion(chosen))?;
            let name = self.effects.effect(pick.effect).name();
            pick.score = without.state.gone.map_or(0.0, |score| score.score);
            pick.probability = probability(found.iter().map(|rival| rival.behind));
            let near = found.iter().filter(|rival| rival.behind < CONFUSABLE_NATS);
            let names = near.map(|rival| rival.name.0);
            pick.rivals = names.filter(|other| *other != name).collect();
        }
        Ok(picks)
    }
}
