//! Joints that yield together: a weight loads every joint between it and the base, so where one yields the
//! others do by the same law, each with a stiffness of its own.

use haptical_effects::{Family, Hook};
use haptical_judge::{Forward, Proposal, Proposals, Ruled, Ruling};

use super::{Grown, Selector, excess};
use crate::engine::{Cause, Refit};
use crate::select::{Score, Tried};
use crate::thresholds::chance::SHARE_OF_REST;
use crate::{DiagnosisError, Result};

impl Selector<'_> {
    /// Takes up further joints that yield, all refitted together, where one does already or would but for what it leaves. One by
    /// one each explains too little of what is left to be believed (a wrong effect nibbles at a gap), and the first, alone, has
    /// a stiffness that makes up for the others: those that were refused are tried again, and all are judged by what they
    /// explain together.
    ///
    /// A base that yields, alone, makes up for all the joints: where it was picked, the joints compete with it as one.
    pub(super) fn springs(&mut self, grown: &mut Grown, refused: Option<&Score>) -> Result<()> {
        let picked = grown.refit.model.causes.iter().map(|cause| cause.effect);
        let mut met = picked.clone().chain(refused.map(|score| score.effect));
        if met.any(|effect| self.is_spring(effect)) {
            let with = self.extended(grown.clone(), Self::is_spring)?;
            let (rest, uncertain) = excess(&grown.after);
            let closed = rest - excess(&with.after).0;
            if closed >= SHARE_OF_REST * (rest - 2.0 * uncertain).max(0.0) {
                *grown = with;
            }
        } else if picked.clone().any(|effect| self.yields_elsewhere(effect)) {
            let mut joints = self.without(grown, Self::yields_elsewhere)?;
            joints = self.extended(joints, Self::is_spring)?;
            joints = self.extended(joints, Self::yields_elsewhere)?;
            self.trim(&mut joints)?;
            if joints.refit.has_converged()
                && self.evidence(&joints) > self.evidence(grown)
                && self.is_beyond_the_first(&joints)
            {
                *grown = joints;
            }
        }
        Ok(())
    }

    /// With further causes of some effects, the best first, while each is more than chance.
    fn extended(&mut self, with: Grown, among: fn(&Self, usize) -> bool) -> Result<Grown> {
        let fewest = with.refit.model.causes.len();
        let mut extension = Extension {
            most: fewest + self.engine.context.device.joints.len(),
            selector: self,
            among,
            tried: Vec::new(),
        };
        haptical_judge::select(&mut extension, with)
    }

    /// Without the causes of some effects, the others refitted.
    fn without(&self, grown: &Grown, these: fn(&Self, usize) -> bool) -> Result<Grown> {
        let mut left = grown.clone();
        let is_kept = |cause: &Cause| !these(self, cause.effect);
        let mut kept = grown.refit.model.causes.iter().map(is_kept);
        left.explained.retain(|_| kept.next().unwrap_or(false));
        left.refit.model.causes.retain(is_kept);
        left.provisional.retain(|score| !these(self, score.effect));
        left.refit = match left.refit.model.causes.is_empty() {
            true => self.engine.start.clone(),
            false => self.engine.refit(self.effects, &left.refit.model)?,
        };
        left.system = self.system_of(&left.refit);
        left.after = left.system.slow_energy(&left.system.residual);
        Ok(left)
    }

    /// Whether a joint yields that is not the first: what yields about and across the first one's axis alone is the base.
    fn is_beyond_the_first(&self, grown: &Grown) -> bool {
        let mut causes = grown.refit.model.causes.iter();
        causes.any(|cause| {
            let joint = self.effects[cause.effect].joint();
            self.is_spring(cause.effect) && joint.is_some_and(|joint| joint > 0)
        })
    }

    /// Evidence of all causes together in nats, but for a constant (Schwarz 1978).
    fn evidence(&self, grown: &Grown) -> f64 {
        let readings = self.engine.system.layout.count().max(2) as f64;
        let causes = grown.refit.model.causes.iter();
        let numbers: usize = causes.map(|cause| cause.amplitudes.len()).sum();
        -0.5 * (self.cost(&grown.refit) + numbers as f64 * readings.ln())
    }

    /// Whether an effect is something beside the joints that yields: the base, or a link across a joint's axis.
    fn yields_elsewhere(&self, effect: usize) -> bool {
        let effect = self.effects[effect].as_ref();
        effect.spec().family == Family::Load && effect.spec().hook == Hook::Structure
    }

    /// Whether an effect is a joint that yields behind its encoders.
    pub(crate) fn is_spring(&self, effect: usize) -> bool {
        let effect = self.effects[effect].as_ref();
        effect.spec().family == Family::Load
            && effect.spec().hook == Hook::Joint
            && effect.joint().is_some()
    }
}

/// Further causes of some effects.
struct Extension<'s, 'e> {
    selector: &'s mut Selector<'e>,
    among: fn(&Selector<'e>, usize) -> bool,
    most: usize,
    tried: Vec<Tried>,
}

impl Forward for Extension<'_, '_> {
    type State = Grown;
    type Further = (Refit, Score);
    type Error = DiagnosisError;

    fn proposals(&mut self, with: &Grown) -> Proposals<Self> {
        if with.refit.model.causes.len() >= self.most {
            return Ok(Vec::new());
        }
        let mut scan = self.selector.scan(&with.system, &with.refit.model);
        scan.retain(|score| (self.among)(self.selector, score.effect));
        let best = (self.selector).best(with, &scan, &mut self.tried, None)?;
        Ok(Proposal::of_best(best, |(_, score)| score.score))
    }

    fn rule(&mut self, with: &Grown, best: Proposal<(Refit, Score)>) -> Ruled<Self> {
        let (refit, score) = best.further;
        let system = self.selector.system_of(&refit);
        let after = system.slow_energy(&system.residual);
        if !self.selector.is_more_than_chance(&score, &after)? {
            return Ok(Ruling::Ended);
        }
        self.tried.clear();
        Ok(Ruling::Taken(with.with(refit, system, after, &score)))
    }
}
