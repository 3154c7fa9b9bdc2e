//! Joints that yield together: a weight loads every joint between it and the base, so where one yields the
//! others do by the same law, each with a stiffness of its own.

use haptical_effects::{Family, Hook};

use super::{Grown, Selector, excess};
use crate::DiagnosisError;
use crate::select::scan::Score;
use crate::thresholds::chance::SHARE_OF_REST;

impl Selector<'_> {
    /// Takes up further joints that yield, all refitted together, where one does already,
    /// or would but for what it leaves. One by one each explains
    /// too little of what is left to be believed (a wrong effect nibbles at a gap), and the first, alone, has a
    /// stiffness that makes up for the others: so those that were refused too are tried again, and all are judged by what they explain together.
    pub(super) fn springs(
        &mut self,
        grown: &mut Grown,
        refused: Option<&Score>,
    ) -> Result<(), DiagnosisError> {
        let picked = grown.refit.model.causes.iter().map(|cause| cause.effect);
        let mut picked = picked.chain(refused.map(|score| score.effect));
        if !picked.any(|effect| self.is_spring(effect)) {
            return Ok(());
        }
        let before = grown.after.clone();
        let mut with = grown.clone();
        let mut tried = Vec::new();
        for _ in 0..self.engine.context.device.joints.len() {
            let mut scan = self.scan(&with.system, &with.refit.model);
            scan.retain(|score| self.is_spring(score.effect));
            let Some((refit, score)) = self.best(&with, &scan, &mut tried)? else {
                break;
            };
            let system = self.system_of(&refit);
            let after = system.slow_energy(&system.residual);
            if !self.is_more_than_chance(&score, &after)? {
                break;
            }
            with.explained.push(score.score);
            (with.refit, with.system, with.after) = (refit, system, after);
            tried.clear();
        }
        let (rest, uncertain) = excess(&before);
        let closed = rest - excess(&with.after).0;
        if closed >= SHARE_OF_REST * (rest - 2.0 * uncertain).max(0.0) {
            *grown = with;
        }
        Ok(())
    }

    /// Whether an effect is a joint that yields behind its encoders.
    fn is_spring(&self, effect: usize) -> bool {
        let effect = self.effects[effect].as_ref();
        effect.spec().family == Family::Load
            && effect.spec().hook == Hook::Joint
            && effect.joint().is_some()
    }
}
