//! Names that could be in the place of one that a joint's cables have.

use haptical_judge::nearest;

use crate::engine::segments::Unseen;
use crate::judge::rivals::with_probabilities;
use crate::select::partial::cables::{Cable, Drive};
use crate::select::rival::Rival;
use crate::thresholds::partial::LEAD_NATS;

impl Drive<'_> {
    /// Each effect with its own name, and what else of its kind could be in its place.
    pub(super) fn rivals(&self, chosen: &[Cable], all: &[Cable]) -> Vec<Vec<Rival>> {
        let whole = self.unseen_with(&chosen.iter().collect::<Vec<_>>());
        let of_place = |place: usize| -> Vec<Rival> {
            let cable = &chosen[place];
            let effect = self.effect(cable.effect);
            let is_other = |other: &&Cable| {
                other.is_instead_of(cable) && self.effect(other.effect).name() != effect.name()
            };
            let others = all.iter().filter(is_other).map(|other| {
                let mut members: Vec<&Cable> = chosen.iter().collect();
                members[place] = other;
                let lead = whole.gain_on(&self.unseen_with(&members)).deviations();
                let other = self.effect(other.effect);
                haptical_judge::Rival {
                    name: other.name(),
                    behind: LEAD_NATS * lead.max(0.0).powi(2),
                    fit: other,
                }
            });
            let others = nearest(others).into_iter();
            let mut list = vec![Rival::new(effect, 1.0, 0.0)];
            list.extend(others.map(|other| Rival::new(other.fit, 1.0, other.behind)));
            with_probabilities(&mut list);
            list
        };
        (0..chosen.len()).map(of_place).collect()
    }

    fn unseen_with(&self, members: &[&Cable]) -> Unseen {
        let mut system = self.base.clone();
        for member in members {
            system.take(member.column.clone());
        }
        self.segments.unseen(&system)
    }
}
