//! Every effect that may be picked next, best first.

use haptical_effects::{Effect, Shape, under_load};

use super::Selector;
use crate::engine::{Cause, Model, System};
use crate::select::{Instants, Score, is_displacement};
use crate::thresholds::chance::{IMPLAUSIBLE_NATS, LEAST_RETAINED};
use crate::thresholds::steps::{COINCIDENT_S, MORE_STEPS_SHARE, WORTH_MORE_STEPS};

impl Selector<'_> {
    /// Every effect's best score, best first by [`Selector::criterion`].
    pub(crate) fn scan(&mut self, system: &System, model: &Model) -> Vec<Score> {
        let known = self.engine.system.basis.len();
        let mut scores: Vec<Score> = haptical_parallel::map(&mut self.candidates, |candidate| {
            candidate.reset(system, known);
            candidate.score(system)
        });
        let largest = scores.iter().map(|score| score.score).fold(0.0, f64::max);
        let events = self.tested.iter().copied().filter(|&index| {
            let effect = self.effects[index].as_ref();
            effect.spec().shape == Shape::Event
        });
        let events = haptical_parallel::map(events, |index| {
            let effect = self.effects[index].as_ref();
            let instants = Instants::new(system, &self.engine.context, effect, index);
            let score = instants.one_step()?;
            let several =
                score.score > WORTH_MORE_STEPS && score.score > MORE_STEPS_SHARE * largest;
            Some(if several {
                instants.with_more_steps(score)
            } else {
                score
            })
        });
        scores.extend(events.into_iter().flatten());
        scores.retain(|score| self.is_eligible(score, model));
        scores.sort_by(|a, b| self.criterion(b).total_cmp(&self.criterion(a)));
        let mut seen = vec![false; self.effects.len()];
        scores.retain(|score| !std::mem::replace(&mut seen[score.effect], true));
        scores
    }

    fn is_eligible(&self, score: &Score, model: &Model) -> bool {
        let effect = self.effects[score.effect].as_ref();
        let context = &self.engine.context;
        // what moved before one run may move again before another
        let is_elsewhere =
            |cause: &Cause| is_displacement(effect.spec()) && cause.shape != score.shape;
        let used = |cause: &Cause| {
            let is_again = cause.effect == score.effect && is_elsewhere(cause);
            !is_again && effect.is_kin_of(self.effects[cause.effect].as_ref())
        };
        let believable = score.retained >= LEAST_RETAINED || self.is_plausible(effect, score);
        let loaded = !effect.spec().under_load
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
            && effect.is_possible(&self.engine.context, &score.amplitudes)
            && !model.causes.iter().any(used)
            && believable
            && loaded
    }

    fn is_plausible(&self, effect: &dyn Effect, score: &Score) -> bool {
        let amplitudes = &score.amplitudes[..effect.spec().amplitudes];
        effect.is_plausible(&effect.values(&self.engine.context, amplitudes, score.shape))
    }

    /// Evidence of a score in nats: half the explained square, less what its freedom costs.
    pub(crate) fn criterion(&self, score: &Score) -> f64 {
        let effect = self.effects[score.effect].as_ref();
        let readings = self.engine.system.layout.count().max(2) as f64;
        let shapes = if effect.spec().shape == Shape::Event {
            let instants = readings / self.engine.context.streams.len().max(1) as f64;
            instants.max(1.0).ln() * score.times.len() as f64
        } else {
            self.shapes_tried(effect).ln()
        };
        let mut criterion = 0.5 * score.score - 0.5 * score.rank as f64 * readings.ln() - shapes
            + effect.spec().log_prior;
        if !self.is_plausible(effect, score) {
            criterion -= IMPLAUSIBLE_NATS;
        }
        criterion
    }
}
