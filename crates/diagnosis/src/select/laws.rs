//! Test of an effect's law: the share that a free function of its own covariates still explains, and that which
//! the other side of the external encoder shows (docs/diagnosis.md, "Adequacy").

use haptical_effects::{Effect, Hook};
use haptical_metrics::chi_square_p_value;

use crate::engine::model::Cause;
use crate::engine::system::System;
use crate::select::Selector;
use crate::select::generic::{self, own_covariates};
use crate::select::scan::Candidate;
use crate::thresholds::selection::{LAW_P, OFF_BY, SURELY};

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
            let Some(score) = generic::score(system, context, place, covariate, knots) else {
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
