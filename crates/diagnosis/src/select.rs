//! Stepwise selection of causes: scan, refit of the best, and a stop where chance or misfit begins.

use haptical_metrics::chi_square_p_value;
use rayon::prelude::*;

use crate::DiagnosisError;
use crate::catalogue::{Effect, Family, Hook, under_load};
use crate::engine::Engine;
use crate::events::{event_score, with_more_steps};
use crate::laws::law_is_kept;
use crate::model::{Cause, Model, Refit};
use crate::noise::Noise;
use crate::scan::{Candidate, Score, candidates};
use crate::system::{SlowEnergy, System};
use crate::thresholds::Thresholds;

/// The causes that were found, and what they leave.
#[derive(Debug)]
pub(crate) struct Selection {
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
}

/// Causes picked so far.
#[derive(Debug)]
pub(crate) struct Grown {
    pub(crate) refit: Refit,
    pub(crate) system: System,
    pub(crate) after: Vec<SlowEnergy>,
    pub(crate) explained: Vec<f64>,
    first_scan: Vec<Score>,
    /// Picks whose law is to be judged beside those that follow.
    provisional: Vec<Score>,
}

/// Picks that were not taken.
#[derive(Debug, Default)]
struct Refused {
    best: Option<Score>,
    /// Their effects, which are not tried again.
    shut: Vec<usize>,
}

impl Refused {
    fn add(&mut self, score: Score) {
        self.shut.push(score.effect);
        self.best.get_or_insert(score);
    }
}

/// Scans and picks.
#[derive(Debug)]
pub(crate) struct Selector<'e, 'a> {
    pub(crate) engine: &'e Engine<'a>,
    pub(crate) effects: &'e [Box<dyn Effect>],
    /// Effects that the recording can test.
    pub(crate) tested: &'e [usize],
    pub(crate) thresholds: &'e Thresholds,
    candidates: Vec<Candidate>,
}

/// Two steps so near to each other are one event, seen by more than one channel \[s\].
const COINCIDENT_S: f64 = 0.8;
/// Share of the earlier laws' possible error that a later pick must exceed where it leaves a rest.
const LATER_PICK: f64 = 0.15;
/// The same of a pick at a joint of theirs.
const LATER_PICK_THERE: f64 = 0.5;
/// Share of what was explained below which nothing is told apart from what large numbers leave.
const DYNAMIC_RANGE: f64 = 2e-4;
/// Picks that are tried and refused before the search ends.
const REFUSALS: usize = 3;
/// Share of the structured energy below which nothing is left that could have moved the base model.
const NEARLY_NOTHING: f64 = 0.01;
/// Change of the base model's predictions by the causes, in noise deviations (root mean square), from
/// which effects are computed anew.
pub(crate) const MOVED_FAR: f64 = 25.0;
/// Share of the structured energy above which other effects are still to come.
const STILL_MUCH: f64 = 0.05;
/// Score from which an event may have further steps.
const WORTH_MORE_STEPS: f64 = 60.0;

impl<'e, 'a> Selector<'e, 'a> {
    pub(crate) fn new(
        engine: &'e Engine<'a>,
        effects: &'e [Box<dyn Effect>],
        tested: &'e [usize],
        thresholds: &'e Thresholds,
    ) -> Self {
        Self {
            engine,
            effects,
            tested,
            thresholds,
            candidates: candidates(&engine.system, &engine.context, effects, tested),
        }
    }

    /// Picks causes until what is left is chance or no effect of the catalogue; or, with `may_stop`, until
    /// the first has explained the gap and moved the base model so far that all must be computed anew.
    pub(crate) fn select(&mut self, may_stop: bool) -> Result<Selection, DiagnosisError> {
        let before = self.engine.system.slow_energy(&self.engine.system.residual);
        let mut refused = Refused::default();
        loop {
            let mut grown = self.grow(&before, &mut refused, may_stop)?;
            self.trim(&mut grown)?;
            let broken = self.broken_in_the_end(&grown);
            match broken.filter(|_| refused.shut.len() <= REFUSALS) {
                Some(score) => refused.add(score),
                None => {
                    return Ok(Selection {
                        refit: grown.refit,
                        before,
                        after: grown.after,
                        explained: grown.explained,
                        system: grown.system,
                        first_scan: grown.first_scan,
                        refused: refused.best,
                    });
                }
            }
        }
    }

    /// Picks without those that were refused.
    fn grow(
        &mut self,
        before: &[SlowEnergy],
        refused: &mut Refused,
        may_stop: bool,
    ) -> Result<Grown, DiagnosisError> {
        let mut grown = Grown {
            refit: self.engine.start.clone(),
            system: self.engine.system.clone(),
            after: before.to_vec(),
            explained: Vec::new(),
            first_scan: Vec::new(),
            provisional: Vec::new(),
        };
        let mut tried = Vec::new();
        loop {
            let mut scan = self.scan(&grown.system, &grown.refit.model);
            scan.retain(|score| !refused.shut.contains(&score.effect));
            if grown.refit.model.causes.is_empty() {
                grown.first_scan.clone_from(&scan);
            }
            let full = grown.refit.model.causes.len() >= self.thresholds.causes;
            if full || refused.shut.len() > REFUSALS {
                break;
            }
            let Some((next, score)) = self.best(&grown, &scan, &mut tried)? else {
                break;
            };
            let system = self.system_of(&next);
            let after = system.slow_energy(&system.residual);
            if !self.is_more_than_chance(&score, &after)? {
                break;
            }
            let is_first = grown.refit.model.causes.is_empty();
            let enough = self.explains_enough(&score, &grown.after, &after);
            if !enough && is_first {
                refused.best.get_or_insert(score);
                break;
            }
            let effect = self.effects[score.effect].as_ref();
            let causes = &grown.refit.model.causes;
            let beyond_laws = is_first
                || (score.score > DYNAMIC_RANGE * grown.explained.iter().sum::<f64>()
                    && ((self.is_quiet_there(effect, &after)
                        && self.is_elsewhere(&score, causes))
                        || score.score > self.law_errors(causes, &grown.explained, &score)));
            let strict = !is_first || effect.family() == Family::Step;
            let keeps_its_law = !strict
                || next.model.causes.last().is_none_or(|cause| {
                    let broken = self.broken_law(&system, effect, cause, score.score);
                    law_is_kept(effect, broken)
                });
            // beside other effects still to come a law cannot be judged
            let much_left = excess(&after).0 > STILL_MUCH * excess(before).0;
            if !enough || !beyond_laws || (!keeps_its_law && !much_left) {
                refused.add(score);
                continue;
            }
            if !keeps_its_law {
                grown.provisional.push(score.clone());
            }
            grown.explained.push(score.score);
            (grown.refit, grown.system, grown.after) = (next, system, after);
            tried.clear();
            if may_stop
                && excess(&grown.after).0 < NEARLY_NOTHING * excess(before).0
                && self.engine.moved(&grown.refit.model.bare) >= MOVED_FAR
            {
                break;
            }
        }
        Ok(grown)
    }

    /// The first cause that was taken up provisionally and whose law is broken beside all others too.
    fn broken_in_the_end(&self, grown: &Grown) -> Option<Score> {
        let causes = grown.refit.model.causes.iter().zip(&grown.explained);
        grown.provisional.iter().find_map(|score| {
            let (cause, explained) = causes
                .clone()
                .find(|(cause, _)| cause.effect == score.effect)?;
            let effect = self.effects[cause.effect].as_ref();
            let broken = self.broken_law(&grown.system, effect, cause, *explained);
            (!law_is_kept(effect, broken)).then(|| score.clone())
        })
    }

    /// Whether a pick is driven by other joints, and shows most in another stream, than all causes so far: no
    /// law of theirs can have left it there.
    pub(crate) fn is_elsewhere(&self, pick: &Score, causes: &[Cause]) -> bool {
        let effect = self.effects[pick.effect].as_ref();
        let joints = self.joints(pick.effect, pick.shape);
        let main = |effect: &dyn Effect| self.main_stream(effect);
        let own = main(effect);
        causes.iter().all(|cause| {
            let other = self.effects[cause.effect].as_ref();
            let theirs = self.joints(cause.effect, cause.shape);
            main(other) != own
                && other.hook() != Hook::Timing
                && !joints.iter().any(|joint| theirs.contains(joint))
        })
    }

    /// The external encoder that shows an effect.
    fn main_stream(&self, effect: &dyn Effect) -> Option<usize> {
        let in_encoder = matches!(effect.hook(), Hook::Transmission | Hook::ExternalEncoder);
        let joint = effect.joint().filter(|_| in_encoder)?;
        self.engine.context.output_stream(joint)
    }

    /// Whether nothing is left in the external encoder that shows an effect; of others, anywhere.
    fn is_quiet_there(&self, effect: &dyn Effect, after: &[SlowEnergy]) -> bool {
        let streams = match self.main_stream(effect) {
            Some(stream) => stream..stream + 1,
            None => 0..after.len(),
        };
        worst_excess(&after[streams.clone()], &self.engine.noise[streams])
            < self.thresholds.omnibus_z
    }

    /// Squared residual that the laws of the causes so far may have got wrong, where a pick shows.
    pub(crate) fn law_errors(&self, causes: &[Cause], explained: &[f64], pick: &Score) -> f64 {
        let own = self.joints(pick.effect, pick.shape);
        let errors = causes.iter().zip(explained).map(|(cause, explained)| {
            let theirs = self.joints(cause.effect, cause.shape);
            let share = if own.iter().any(|joint| theirs.contains(joint)) {
                LATER_PICK_THERE
            } else {
                LATER_PICK
            };
            share * self.effects[cause.effect].family().law_error() * explained
        });
        errors.sum()
    }

    /// Joints whose angle drives an effect, from 0.
    fn joints(&self, effect: usize, shape: f64) -> Vec<usize> {
        let effect = self.effects[effect].as_ref();
        let from =
            (effect.family() == Family::Coupling).then(|| (shape as usize).saturating_sub(1));
        effect.joint().into_iter().chain(from).collect()
    }

    /// Every effect but events at every shape.
    pub(crate) fn base_candidates(&self) -> impl Iterator<Item = &Candidate> {
        self.candidates.iter()
    }

    /// The same selection with another effect in a cause's place, if that refits better.
    pub(crate) fn replace(
        &self,
        selection: &mut Selection,
        cause: usize,
        by: Cause,
    ) -> Result<bool, DiagnosisError> {
        let mut model = selection.refit.model.clone();
        model.causes[cause] = by;
        let fitted = self.engine.refit(self.effects, &model)?;
        if !self.is_possible(&fitted.model)
            || self.cost(&fitted) > self.cost(&selection.refit) + 9.0
        {
            return Ok(false);
        }
        selection.system = self.system_of(&fitted);
        selection.after = selection.system.slow_energy(&selection.system.residual);
        selection.refit = fitted;
        Ok(true)
    }

    /// The system of a model: its causes projected out, its residuals in place.
    pub(crate) fn system_of(&self, refit: &Refit) -> System {
        let mut system = self.engine.system.clone();
        for cause in &refit.model.causes {
            for signal in cause.derivative(self.effects, &self.engine.context) {
                let column = system.column(&signal);
                system.project_out(&column);
            }
        }
        system.set_residual(&refit.residual);
        system
    }

    /// Every effect's best score, best first by [`Selector::criterion`].
    pub(crate) fn scan(&mut self, system: &System, model: &Model) -> Vec<Score> {
        let known = self.engine.system.basis.len();
        let mut scores: Vec<Score> = Vec::new();
        self.candidates
            .par_iter_mut()
            .map(|candidate| {
                candidate.reset(system, known);
                candidate.score(system)
            })
            .collect_into_vec(&mut scores);
        let largest = scores.iter().map(|score| score.score).fold(0.0, f64::max);
        let events: Vec<Score> = self
            .tested
            .par_iter()
            .filter_map(|&index| {
                let effect = self.effects[index].as_ref();
                let context = &self.engine.context;
                if !effect.is_event() {
                    return None;
                }
                let score = event_score(system, context, effect, index)?;
                let several = score.score > WORTH_MORE_STEPS && score.score > 0.3 * largest;
                Some(if several {
                    with_more_steps(system, context, effect, score)
                } else {
                    score
                })
            })
            .collect();
        scores.extend(events);
        scores.retain(|score| self.is_eligible(score, model));
        scores.sort_by(|a, b| self.criterion(b).total_cmp(&self.criterion(a)));
        let mut seen = vec![false; self.effects.len()];
        scores.retain(|score| !std::mem::replace(&mut seen[score.effect], true));
        scores
    }

    fn is_eligible(&self, score: &Score, model: &Model) -> bool {
        let effect = self.effects[score.effect].as_ref();
        let context = &self.engine.context;
        let used = |cause: &Cause| {
            cause.effect == score.effect || effect.is_kin_of(self.effects[cause.effect].as_ref())
        };
        let believable =
            score.retained >= self.thresholds.retained || self.is_plausible(effect, score);
        let loaded = effect.name() != "capstan-slip"
            || effect.joint().is_some_and(|joint| {
                score
                    .times
                    .iter()
                    .any(|&time| under_load(context, joint, time))
            });
        let time_s = context.recording.time_s.as_ref();
        let near = |a: f64, b: f64| {
            time_s.is_some_and(|time_s| {
                let at = |row: f64| time_s.get(row as usize).copied().unwrap_or(f64::NAN);
                (at(a) - at(b)).abs() < COINCIDENT_S
            })
        };
        let coincides = |cause: &Cause| {
            let mut rows = cause.times.iter();
            rows.any(|row| score.times.iter().any(|other| near(*row, *other)))
        };
        score.rank > 0
            && !model.causes.iter().any(coincides)
            && score.score.is_finite()
            && effect.is_possible(&score.amplitudes)
            && !model.causes.iter().any(used)
            && believable
            && loaded
    }

    fn is_plausible(&self, effect: &dyn Effect, score: &Score) -> bool {
        values_are_plausible(
            effect,
            &effect.values(
                &self.engine.context,
                &score.amplitudes[..effect.amplitude_count()],
                score.shape,
            ),
        )
    }

    /// Evidence of a score in nats: half the explained square, less what its freedom costs.
    pub(crate) fn criterion(&self, score: &Score) -> f64 {
        let effect = self.effects[score.effect].as_ref();
        let readings = self.engine.system.blocks.count().max(2) as f64;
        let shapes = if effect.is_event() {
            let instants = readings / self.engine.context.streams.len().max(1) as f64;
            instants.max(1.0).ln() * score.times.len() as f64
        } else {
            (effect.shapes(&self.engine.context).len().max(1) as f64).ln()
        };
        let mut criterion = 0.5 * score.score - 0.5 * score.rank as f64 * readings.ln() - shapes
            + effect.log_prior();
        if !self.is_plausible(effect, score) {
            criterion -= self.thresholds.implausible_nats;
        }
        criterion
    }

    pub(crate) fn is_worth_a_refit(&self, score: &Score) -> Result<bool, DiagnosisError> {
        Ok(self.family_wise_p(score, 1.0)? < self.thresholds.family_wise_p)
    }

    /// Probability that chance gives any effect of the catalogue a score like this, misfit allowed for
    /// as more noise (Bonferroni over effects, shapes and instants).
    pub(crate) fn family_wise_p(&self, score: &Score, misfit: f64) -> Result<f64, DiagnosisError> {
        let effect = self.effects[score.effect].as_ref();
        let tries = if effect.is_event() {
            let instants = 0.15 * self.engine.system.blocks.count() as f64
                / self.engine.context.streams.len().max(1) as f64;
            instants.max(1.0).powi(score.times.len().max(1) as i32)
        } else {
            effect.shapes(&self.engine.context).len() as f64
        };
        let p = chi_square_p_value(score.score / misfit, score.rank as f64)?;
        Ok((p * tries.max(1.0) * self.tested.len() as f64).min(1.0))
    }

    pub(crate) fn is_more_than_chance(
        &self,
        score: &Score,
        after: &[SlowEnergy],
    ) -> Result<bool, DiagnosisError> {
        let p = self.family_wise_p(score, misfit(after))?;
        Ok(p < self.thresholds.family_wise_p)
    }

    /// Whether a pick explains enough of what was left: a wrong effect nibbles at a gap.
    fn explains_enough(&self, score: &Score, before: &[SlowEnergy], after: &[SlowEnergy]) -> bool {
        let share = self.thresholds.share_of_rest;
        if self.engine.is_noise_unknown() {
            // what is noise and what is gap only the cause itself tells
            let all: f64 = before.iter().map(|stream| stream.energy).sum();
            return score.score >= share * all;
        }
        let (rest, uncertain) = excess(before);
        let (left, _) = excess(after);
        score.score >= share * (rest - 2.0 * uncertain) || rest - left >= share * rest
    }
}

/// Slow residuals over what noise gives, at least 1.
pub(crate) fn misfit(energy: &[SlowEnergy]) -> f64 {
    let (sum, freedom) = energy.iter().fold((0.0, 0.0), |(sum, freedom), stream| {
        (sum + stream.energy, freedom + stream.freedom)
    });
    if freedom > 0.0 {
        (sum / freedom).max(1.0)
    } else {
        1.0
    }
}

/// Largest excess of a stream in standard deviations, the noise's own uncertainty allowed for.
pub(crate) fn worst_excess(energy: &[SlowEnergy], noise: &[Noise]) -> f64 {
    energy
        .iter()
        .zip(noise)
        .map(|(stream, noise)| {
            if stream.freedom <= 1.0 {
                return of_one_reading(*stream);
            }
            let spread = (2.0 * stream.freedom)
                .sqrt()
                .hypot(stream.freedom * noise.uncertainty);
            stream.excess() / spread.max(1.0)
        })
        .fold(f64::NEG_INFINITY, f64::max)
}

/// Freedom below which the base model takes a single reading up: it says nothing.
const TAKEN_UP: f64 = 0.1;

/// Excess of a single reading, such as the known distance of two sockets, in standard deviations: its square is
/// far from normal (Wilson & Hilferty 1931).
fn of_one_reading(stream: SlowEnergy) -> f64 {
    if stream.freedom <= TAKEN_UP {
        return f64::NEG_INFINITY;
    }
    let spread = 2.0 / (9.0 * stream.freedom);
    ((stream.energy / stream.freedom).max(0.0).cbrt() - (1.0 - spread)) / spread.sqrt()
}

/// Structured energy over all streams, and its standard deviation under noise.
pub(crate) fn excess(energy: &[SlowEnergy]) -> (f64, f64) {
    let sum = energy.iter().map(|stream| stream.excess()).sum();
    let variance: f64 = energy.iter().map(|stream| 2.0 * stream.freedom).sum();
    (sum, variance.sqrt())
}

pub(crate) fn values_are_plausible(effect: &dyn Effect, values: &[f64]) -> bool {
    effect
        .parameters()
        .iter()
        .zip(values)
        .all(|(spec, value)| value.abs() <= spec.plausible[1] && value.abs() >= spec.plausible[0])
}
