//! Test of an effect's law: the share that a free function of its own covariates still explains, and that which
//! the other side of the external encoder shows (docs/diagnosis.md, "Adequacy").

use haptical_effects::{Effect, Hook};
use haptical_metrics::chi_square_p_value;

use crate::engine::{Cause, SlowEnergy, System};
use crate::select::{Candidate, Score, Selector, own_covariates, score, worst_excess};
use crate::thresholds::chance::OMNIBUS_Z;
use crate::thresholds::selection::{LATER_PICK, LATER_PICK_THERE, LAW_P, OFF_BY, SURELY};

impl Selector<'_> {
    /// What a free function of an effect's own covariates explains after the effect: share of the
    /// effect's energy, and its probability by chance.
    pub(crate) fn broken_law(
        &self,
        system: &System,
        effect: &dyn Effect,
        cause: &Cause,
        explained: f64,
    ) -> (f64, f64) {
        let mut worst = self.other_side(system, effect, cause, explained);
        for (place, covariate, knots) in own_covariates(effect) {
            let context = &self.engine.context;
            let Some(score) = score(system, context, place, covariate, knots) else {
                continue;
            };
            let freedom = score.rank.max(1) as f64;
            let p = chi_square_p_value(score.score, freedom).unwrap_or(1.0);
            if p < worst.1 {
                worst = ((score.score - freedom).max(0.0) / explained.max(1e-300), p);
            }
        }
        worst
    }

    /// The same course of an effect on the chain alone: what is left of it there if the effect sits on the
    /// other side of the external encoder, or is the encoder's own.
    pub(super) fn other_side(
        &self,
        system: &System,
        effect: &dyn Effect,
        cause: &Cause,
        explained: f64,
    ) -> (f64, f64) {
        let context = &self.engine.context;
        let in_encoder = matches!(
            effect.spec().hook,
            Hook::Transmission | Hook::ExternalEncoder
        );
        let Some((joint, stream)) = effect
            .joint()
            .and_then(|joint| Some((joint, context.output_stream(joint)?)))
            .filter(|_| in_encoder)
        else {
            return (0.0, 1.0);
        };
        let signal = cause.contribution(self.effects, context);
        let Some(course) = signal.on(stream) else {
            return (0.0, 1.0);
        };
        let chain = context.downstream(joint, course);
        if chain.parts.is_empty() {
            return (0.0, 1.0);
        }
        let score = Candidate::of_signals(system, &[chain], usize::MAX, 0.0).score(system);
        if score.rank == 0 {
            return (0.0, 1.0);
        }
        let p = chi_square_p_value(score.score, 1.0).unwrap_or(1.0);
        // one is the whole course
        let off = score.amplitudes.first().copied().unwrap_or(0.0).abs();
        if off > OFF_BY && p < SURELY {
            return (1.0, p);
        }
        ((score.score - 1.0).max(0.0) / explained.max(1e-300), p)
    }

    /// Whether what a free function still explains is chance, or within what the law may get wrong.
    pub(crate) fn law_is_kept(effect: &dyn Effect, (share, p): (f64, f64)) -> bool {
        share <= effect.spec().law_error.share || p > LAW_P
    }
}

impl Selector<'_> {
    /// Whether a pick is driven by other joints, and shows most in another stream, than all causes so far: no
    /// law of theirs can have left it there.
    pub(crate) fn is_elsewhere(&self, pick: &Score, causes: &[Cause]) -> bool {
        let effect = self.effects[pick.effect].as_ref();
        let joints = self.joints(pick.effect);
        let main = |effect: &dyn Effect| self.main_stream(effect);
        let own = main(effect);
        causes.iter().all(|cause| {
            let other = self.effects[cause.effect].as_ref();
            let theirs = self.joints(cause.effect);
            main(other) != own
                && other.spec().hook != Hook::Timing
                && !joints.iter().any(|joint| theirs.contains(joint))
        })
    }

    /// The external encoder that shows an effect.
    fn main_stream(&self, effect: &dyn Effect) -> Option<usize> {
        let in_encoder = matches!(
            effect.spec().hook,
            Hook::Transmission | Hook::ExternalEncoder
        );
        let joint = effect.joint().filter(|_| in_encoder)?;
        self.engine.context.output_stream(joint)
    }

    /// Whether nothing is left in the external encoder that shows an effect; of others, anywhere.
    pub(super) fn is_quiet_there(&self, effect: &dyn Effect, after: &[SlowEnergy]) -> bool {
        let streams = match self.main_stream(effect) {
            Some(stream) => stream..stream + 1,
            None => 0..after.len(),
        };
        worst_excess(&after[streams.clone()], &self.engine.noise[streams]) < OMNIBUS_Z
    }

    /// Squared residual that the laws of the causes so far may have got wrong, where a pick shows.
    pub(crate) fn law_errors(&self, causes: &[Cause], explained: &[f64], pick: &Score) -> f64 {
        let own = self.joints(pick.effect);
        let errors = causes.iter().zip(explained).map(|(cause, explained)| {
            let theirs = self.joints(cause.effect);
            let share = if own.iter().any(|joint| theirs.contains(joint)) {
                LATER_PICK_THERE
            } else {
                LATER_PICK
            };
            share * self.effects[cause.effect].spec().law_error.share * explained
        });
        errors.sum()
    }

    /// Joints whose angle drives an effect, from 0.
    fn joints(&self, effect: usize) -> Vec<usize> {
        let effect = self.effects[effect].as_ref();
        effect
            .joint()
            .into_iter()
            .chain(effect.other_joint())
            .collect()
    }
}
