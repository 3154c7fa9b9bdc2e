//! Possible errors of the laws of earlier causes, in the streams where a later pick shows.

use haptical_effects::{Effect, Hook};

use super::{Selector, worst_excess};
use crate::engine::model::Cause;
use crate::engine::system::SlowEnergy;
use crate::select::scan::Score;
use crate::thresholds::chance::OMNIBUS_Z;
use crate::thresholds::selection::{LATER_PICK, LATER_PICK_THERE};

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
