//! Names that could be in the place of one that a joint's cables have.

use crate::engine::segments::Unseen;
use crate::judge::rivals::with_probabilities;
use crate::select::partial::cables::{Cable, Drive};
use crate::select::rival::Rival;
use crate::thresholds::partial::LEAD_NATS;

impl Drive<'_> {
    /// Each effect with its own name, and what else of its kind could be in its place.
    pub(super) fn rivals(&self, chosen: &[Cable], all: &[Cable]) -> Vec<Vec<Rival>> {
        let own = self.unseen_with(&chosen.iter().collect::<Vec<_>>());
        let of_place = |place: usize| -> Vec<Rival> {
            let cable = &chosen[place];
            let name = self.effect(cable.effect).name();
            let mut others: Vec<Rival> = Vec::new();
            for other in all {
                let effect = self.effect(other.effect);
                if !other.is_instead_of(cable) || effect.name() == name {
                    continue;
                }
                let mut members: Vec<&Cable> = chosen.iter().collect();
                members[place] = other;
                let lead = own.gain_on(&self.unseen_with(&members)).deviations();
                let lead = lead.max(0.0);
                let nats_behind = LEAD_NATS * lead * lead;
                match others.iter_mut().find(|rival| rival.name == effect.name()) {
                    Some(rival) => rival.nats_behind = rival.nats_behind.min(nats_behind),
                    None => others.push(self.rival(other.effect, nats_behind)),
                }
            }
            let mut list = vec![self.rival(cable.effect, 0.0)];
            list.extend(others);
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

    fn rival(&self, effect: usize, nats_behind: f64) -> Rival {
        let effect = self.effect(effect);
        Rival {
            has_converged: true,
            cause: None,
            name: effect.name(),
            joint: effect.joint(),
            share: 1.0,
            nats_behind,
            probability: 0.0,
        }
    }
}
