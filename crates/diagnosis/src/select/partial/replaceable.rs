//! Hypotheses that could be in another one's place.

use haptical_effects::{Effect, Family};
use haptical_judge::nearest;

use crate::engine::segments::Unseen;
use crate::judge::rivals::with_probabilities;
use crate::select::Selector;
use crate::select::partial::hypotheses::Hypothesis;
use crate::select::rival::Rival;
use crate::thresholds::partial::{LEAD_NATS, SEGMENTS};

impl Selector<'_> {
    /// Each cause of a hypothesis with the hypotheses that could be in its place: a normal lead on unseen rows, and what
    /// each number costs (Schwarz 1978).
    pub(super) fn rivals_of(
        &self,
        best: &Hypothesis,
        found: &[Hypothesis],
        before: &Unseen,
    ) -> Vec<Vec<Rival>> {
        let gained = best.unseen.gain_on(before).sum;
        let share = |hypothesis: &Hypothesis| hypothesis.unseen.gain_on(before).sum / gained;
        let others = found
            .iter()
            .filter(|other| !other.is_part_of(best) && !best.is_part_of(other));
        let others = others.filter_map(|other| {
            let lead = best.unseen.gain_on(&other.unseen).deviations_by_sign();
            let first = other.causes.first()?;
            let more = other.numbers() as f64 - best.numbers() as f64;
            let nats_behind = LEAD_NATS * (lead.max(0.0).powi(2) + more * (SEGMENTS as f64).ln());
            let effect = self.effects[first.effect].as_ref();
            Some(Rival::new(effect, share(other), nats_behind.max(0.0)))
        });
        let others = others.chain(self.loops_between_postures(best));
        let others = nearest(others.map(|rival| haptical_judge::Rival {
            name: rival.name,
            behind: rival.nats_behind,
            fit: rival,
        }));
        let lists = best.causes.iter().map(|cause| {
            let effect = self.effects[cause.effect].as_ref();
            let mut list = vec![Rival::new(effect, share(best), 0.0)];
            list.extend(others.iter().map(|other| other.fit.clone()));
            with_probabilities(&mut list);
            list
        });
        lists.collect()
    }
}

impl Selector<'_> {
    /// Other loops at the joint of a loop: between single postures all are at one end or the other, so that nothing but their
    /// prior odds and the shapes that were tried tells them apart.
    fn loops_between_postures(&self, best: &Hypothesis) -> Vec<Rival> {
        let Some(first) = best.causes.first() else {
            return Vec::new();
        };
        let effect = self.effects[first.effect].as_ref();
        if self.engine.context.ordered || effect.spec().family != Family::Loop {
            return Vec::new();
        }
        let cost = |effect: &dyn Effect| self.shapes_tried(effect).ln() - effect.spec().log_prior;
        let others = self
            .tested
            .iter()
            .map(|&index| self.effects[index].as_ref());
        let twins = others.filter(|other| {
            let (own, spec) = (effect.spec(), other.spec());
            spec.family == Family::Loop
                && (spec.hook, other.joint()) == (own.hook, effect.joint())
                && spec.name != own.name
        });
        twins
            .map(|other| Rival::new(other, 1.0, (cost(other) - cost(effect)).max(0.0)))
            .collect()
    }
}
