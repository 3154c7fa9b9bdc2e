//! Significance of a pick, and the share that it must explain.

use haptical_effects::{Effect, Shape};
use haptical_metrics::chi_square_p_value;

use super::{Selector, excess, misfit};
use crate::DiagnosisError;
use crate::engine::system::SlowEnergy;
use crate::select::scan::Score;
use crate::thresholds::chance::{FAMILY_WISE_P, SHARE_OF_REST};
use crate::thresholds::steps::INSTANTS;

/// Probability that chance gives any of some tests a score like this, misfit allowed for as more noise (Bonferroni).
pub(crate) fn family_wise_p(score: &Score, misfit: f64, tests: f64) -> Result<f64, DiagnosisError> {
    let p = chi_square_p_value(score.score / misfit, score.rank as f64)?;
    Ok((p * tests).min(1.0))
}

impl Selector<'_> {
    pub(crate) fn is_worth_a_refit(&self, score: &Score) -> Result<bool, DiagnosisError> {
        Ok(self.family_wise_p(score, 1.0)? < FAMILY_WISE_P)
    }

    /// Probability that chance gives any effect of the catalogue a score like this, misfit allowed for
    /// as more noise (Bonferroni over effects, shapes and instants).
    pub(crate) fn family_wise_p(&self, score: &Score, misfit: f64) -> Result<f64, DiagnosisError> {
        let effect = self.effects[score.effect].as_ref();
        let tries = if effect.spec().shape == Shape::Event {
            let instants = INSTANTS * self.engine.system.layout.count() as f64
                / self.engine.context.streams.len().max(1) as f64;
            instants.max(1.0).powi(score.times.len().max(1) as i32)
        } else {
            self.shapes_tried(effect)
        };
        family_wise_p(score, misfit, tries.max(1.0) * self.tested.len() as f64)
    }

    /// Shapes among which an effect's was found, at least 1; of a line all frequencies that the rows can show.
    pub(super) fn shapes_tried(&self, effect: &dyn Effect) -> f64 {
        let context = &self.engine.context;
        let tried = match effect.spec().shape {
            Shape::Line => context.rows() / 2,
            _ => effect.shapes(context).len(),
        };
        tried.max(1) as f64
    }

    pub(crate) fn is_more_than_chance(
        &self,
        score: &Score,
        after: &[SlowEnergy],
    ) -> Result<bool, DiagnosisError> {
        let p = self.family_wise_p(score, misfit(after))?;
        Ok(p < FAMILY_WISE_P)
    }

    /// Whether a pick explains enough of what was left: a wrong effect nibbles at a gap.
    pub(super) fn explains_enough(
        &self,
        score: &Score,
        before: &[SlowEnergy],
        after: &[SlowEnergy],
    ) -> bool {
        let share = SHARE_OF_REST;
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
