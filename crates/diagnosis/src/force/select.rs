//! Stepwise selection of effects on the torques, with the rivals of each.

use haptical_effects::transmission::INPUT_DRUM_HARMONIC;
use haptical_linalg::golden_section;

use super::base::Base;
use super::effects::{Effects, is_harmonic, is_scale, is_sensor_loop};
use crate::DiagnosisError;
use crate::engine::system::SlowEnergy;
use crate::select::chance::family_wise_p;
use crate::select::scan::{Candidate, Score};
use crate::select::{excess, misfit};
use crate::thresholds::chance::CONFUSABLE_NATS;
use crate::thresholds::torque::{
    FAMILY_WISE_P, LEAST_LOOP, LEAST_RETAINED, LEAST_SHARE_OF_NOISE, MOST_NAMES, MOST_ORDERS,
    MOST_RIPPLES, SHAPE_STEP, SHARE_OF_REST, TRANSITION_REACH, TRANSITION_STEPS,
};

/// A chosen effect.
#[derive(Debug, Clone)]
pub(super) struct Pick {
    /// Position in the catalogue.
    pub(super) effect: usize,
    pub(super) shape: f64,
    /// Its columns among the model's.
    pub(super) first: usize,
    /// The last of them is the derivative by the logarithm of a continuous shape.
    pub(super) count: usize,
    /// Chi-square that it saves with the others kept.
    pub(super) score: f64,
    pub(super) probability: f64,
    /// Other names that would do nearly as well.
    pub(super) rivals: Vec<&'static str>,
}

/// What the selection came to.
#[derive(Debug)]
pub(super) struct Selection {
    pub(super) picks: Vec<Pick>,
    /// Slow energy per channel of the base model, and of the picks' model.
    pub(super) before: Vec<SlowEnergy>,
    pub(super) after: Vec<SlowEnergy>,
    pub(super) rest_before: Vec<f64>,
    pub(super) rest_after: Vec<f64>,
}

impl Effects<'_, '_> {
    pub(super) fn energy(&self, base: &Base) -> Vec<SlowEnergy> {
        base.energy(self.along.recorded.free_directions())
    }

    /// An arm that moves by itself has friction in every joint.
    fn most_names(&self) -> usize {
        let recorded = self.along.recorded;
        match recorded.moves_by_itself() {
            true => MOST_NAMES.max(recorded.channels.len()),
            false => MOST_NAMES,
        }
    }

    /// Chooses effects one after the other; they become base columns of `base`.
    pub(super) fn select(&self, base: &mut Base) -> Result<Selection, DiagnosisError> {
        let mut candidates = self.candidates(base);
        let mut rest_before = base.rest();
        let mut before = self.energy(base);
        let mut after = before.clone();
        let mut picks: Vec<Pick> = Vec::new();
        let mut ripples: Vec<(usize, f64)> = Vec::new();
        while picks.len() < self.most_names() {
            let scores = self.scores(base, &mut candidates).into_iter();
            let open = scores.filter(|score| !self.is_taken(score, &picks, &ripples));
            let Some(score) = open.max_by(|a, b| self.merit(a).total_cmp(&self.merit(b))) else {
                break;
            };
            let effect = self.effect(score.effect);
            let fresh = is_scale(effect) || picks.is_empty();
            let rest = excess(&after).0.max(0.0);
            let is_part = fresh || is_harmonic(effect) || score.score >= SHARE_OF_REST * rest;
            if !self.is_found(&score, candidates.len())?
                || !is_part
                || !self.is_a_loop(base, &score)
            {
                break;
            }
            if is_harmonic(effect) && ripples.len() < MOST_RIPPLES {
                let columns = self.ripple(base, score.effect, score.shape);
                let rival = base.score(columns.clone());
                if rival.rank > 0 && self.merit_as(&score, &rival) > self.merit(&score) {
                    base.adopt(&columns);
                    ripples.push((score.effect, score.shape));
                    if picks.is_empty() {
                        // what an angle's error adds is no gap of the torques
                        rest_before = base.rest();
                        before = self.energy(base);
                        after = before.clone();
                    }
                    continue;
                }
            }
            picks.push(self.taken(base, &score));
            if is_scale(effect) {
                self.along.settle(base);
                for candidate in &mut candidates {
                    candidate.reset(&base.regression.system, base.scales);
                }
            }
            after = self.energy(base);
        }
        let rest_after = base.rest();
        if !picks.is_empty() {
            self.compare(base, &mut candidates, &mut picks, &after)?;
        }
        Ok(Selection {
            picks,
            before,
            after,
            rest_before,
            rest_after,
        })
    }

    /// Whether an effect is in the model already, at its place; of the harmonics of a motor's angle some may be.
    fn is_taken(&self, score: &Score, picks: &[Pick], ripples: &[(usize, f64)]) -> bool {
        let effect = self.effect(score.effect);
        let at_place = |other: usize| {
            let other = self.effect(other);
            other.name() == effect.name() && other.joint() == effect.joint()
        };
        let mut picked = picks.iter().filter(|pick| at_place(pick.effect));
        if !is_harmonic(effect) {
            return picked.next().is_some();
        }
        let own = (score.effect, score.shape);
        picked.clone().count() >= MOST_ORDERS
            || picked.any(|pick| (pick.effect, pick.shape) == own)
            || ripples.contains(&own)
    }

    /// Bayes' criterion: the score less what as many free numbers explain of nothing.
    pub(super) fn merit(&self, score: &Score) -> f64 {
        self.merit_as(score, score)
    }

    /// The same of a score of something in an effect's place.
    fn merit_as(&self, effect: &Score, score: &Score) -> f64 {
        let shapes = self.shapes(effect.effect).len() as f64;
        score.score - score.rank as f64 * self.rows().ln() - 2.0 * shapes.ln()
    }

    fn is_found(&self, score: &Score, tested: usize) -> Result<bool, DiagnosisError> {
        let p = family_wise_p(score, 1.0, tested as f64)?;
        let is_large = is_scale(self.effect(score.effect))
            || score.score >= LEAST_SHARE_OF_NOISE * self.rows();
        Ok(p < FAMILY_WISE_P && is_large && score.retained > LEAST_RETAINED)
    }

    /// Whether a hysteresis shows as a loop: a state that hardly reverses is a bias, one that hardly saturates a gain.
    /// These are asked whether or not the catalogue has them.
    fn is_a_loop(&self, base: &Base, score: &Score) -> bool {
        if !is_sensor_loop(self.effect(score.effect)) {
            return true;
        }
        let mut beside = base.clone();
        beside.adopt(&self.bias_and_gain(base));
        let columns = self.columns(base, score.effect, score.shape);
        beside.score(columns).score >= LEAST_LOOP * score.score
    }

    /// Adds an effect to the regression, its shape searched.
    pub(super) fn taken(&self, base: &mut Base, score: &Score) -> Pick {
        let (shape, columns) = self.refined(base, score);
        let pick = Pick {
            effect: score.effect,
            shape,
            first: base.regression.len(),
            count: columns.len(),
            score: score.score,
            probability: 1.0,
            rivals: Vec::new(),
        };
        for column in columns {
            base.regression.add(column);
        }
        pick
    }

    /// The shape of an effect searched between those of the grid (golden section), and its columns with the
    /// derivative by the shape's logarithm.
    fn refined(&self, base: &Base, pick: &Score) -> (f64, Vec<Vec<f64>>) {
        let columns = |shape: f64| self.columns(base, pick.effect, shape);
        let dense = |shape: f64| -> Vec<Vec<f64>> {
            let columns = columns(shape);
            let columns = columns.iter();
            columns
                .map(|column| base.regression.system.dense(column))
                .collect()
        };
        if !self.effect(pick.effect).spec().shape.is_continuous() {
            return (pick.shape, dense(pick.shape));
        }
        let placed = |log: f64| pick.shape * log.exp();
        let at = |log: f64| base.score(columns(placed(log))).score;
        let reach = TRANSITION_REACH.ln();
        let best = golden_section([-reach, reach], TRANSITION_STEPS, at);
        let shape = placed(best);
        let amplitudes = base.score(columns(shape)).amplitudes;
        let mut columns = dense(shape);
        let mut slope = vec![0.0; base.regression.reading().len()];
        for (side, log) in [(1.0, best + SHAPE_STEP), (-1.0, best - SHAPE_STEP)] {
            for (column, amplitude) in dense(placed(log)).iter().zip(&amplitudes) {
                let factor = side * amplitude / (2.0 * SHAPE_STEP);
                for (sum, value) in slope.iter_mut().zip(column) {
                    *sum += factor * value;
                }
            }
        }
        columns.push(slope);
        (shape, columns)
    }

    /// For each pick: what it saves with the others kept, and who would do as well in its place.
    fn compare(
        &self,
        base: &Base,
        candidates: &mut [Candidate],
        picks: &mut Vec<Pick>,
        after: &[SlowEnergy],
    ) -> Result<(), DiagnosisError> {
        let first = picks.iter().map(|pick| pick.first).min().unwrap_or(0);
        let mut without = base.clone();
        // whatever is between picks (ripples) stays where it is
        let columns = without.regression.truncate(first);
        let known = without.regression.system.basis.len();
        let dispersion = misfit(after);
        let mut kept = vec![true; picks.len()];
        for (index, pick) in picks.iter_mut().enumerate() {
            let own = pick.first - first..pick.first - first + pick.count;
            let mut beside = without.clone();
            for (index, column) in columns.iter().enumerate() {
                if !own.contains(&index) {
                    beside.regression.add(column.clone());
                }
            }
            for candidate in candidates.iter_mut() {
                candidate.reset(&beside.regression.system, known);
            }
            let layout = &beside.regression.system.layout;
            let own = columns[own].iter().map(|own| layout.split(own)).collect();
            let score = Score {
                effect: pick.effect,
                shape: pick.shape,
                ..beside.score(own)
            };
            pick.score = score.score;
            kept[index] = self.is_found(&score, candidates.len())?;
            let own = self.merit(&score);
            let effect = self.effect(pick.effect);
            let mut best: Vec<(&'static str, Option<usize>, f64)> = Vec::new();
            for rival in self.scores(&beside, candidates) {
                let nats = 0.5 * (own - self.merit(&rival)) / dispersion;
                let other = self.effect(rival.effect);
                let (name, joint) = (other.name(), other.joint());
                let is_own = name == effect.name() && joint == effect.joint();
                if is_own || rival.retained < LEAST_RETAINED {
                    continue;
                }
                match best.iter_mut().find(|b| b.0 == name && b.1 == joint) {
                    Some(known) => known.2 = known.2.min(nats),
                    None => best.push((name, joint, nats)),
                }
            }
            if is_harmonic(effect) {
                let ripple = beside.score(self.ripple(&beside, pick.effect, pick.shape));
                let nats = 0.5 * (own - self.merit_as(&score, &ripple)) / dispersion;
                best.push((INPUT_DRUM_HARMONIC.name, effect.joint(), nats));
            }
            let sum: f64 = best.iter().map(|rival| (-rival.2).min(50.0).exp()).sum();
            pick.probability = 1.0 / (1.0 + sum);
            pick.rivals = best
                .into_iter()
                .filter(|(name, _, nats)| *nats < CONFUSABLE_NATS && *name != effect.name())
                .map(|(name, ..)| name)
                .collect();
            // a second effect that does worse than another shape of the first makes up for its
            // misfit
            kept[index] &= index == 0 || pick.probability > 0.5;
        }
        let mut index = 0;
        picks.retain(|_| {
            index += 1;
            kept[index - 1]
        });
        Ok(())
    }
}
