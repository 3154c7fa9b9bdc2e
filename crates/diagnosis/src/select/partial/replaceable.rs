//! Hypotheses that could be in another one's place.

use crate::engine::segments::Unseen;
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
        let rival = |hypothesis: &Hypothesis, effect: usize, nats_behind: f64| {
            let effect = self.effects[effect].as_ref();
            Rival {
                cause: None,
                name: effect.name(),
                joint: effect.joint(),
                share: hypothesis.unseen.gain_on(before).sum / gained,
                nats_behind,
                probability: (-nats_behind).exp(),
            }
        };
        let others = found
            .iter()
            .filter(|other| !other.is_part_of(best) && !best.is_part_of(other));
        let mut others: Vec<Rival> = others
            .filter_map(|other| {
                let lead = best.unseen.gain_on(&other.unseen).deviations().max(0.0);
                let first = other.causes.first()?;
                let more = other.numbers() as f64 - best.numbers() as f64;
                let nats_behind = LEAD_NATS * (lead * lead + more * (SEGMENTS as f64).ln());
                Some(rival(other, first.effect, nats_behind.max(0.0)))
            })
            .collect();
        others.sort_by(|a, b| a.nats_behind.total_cmp(&b.nats_behind));
        merge_names(&mut others);
        let sum: f64 = 1.0 + others.iter().map(|other| other.probability).sum::<f64>();
        let lists = best.causes.iter().map(|cause| {
            let mut list = vec![rival(best, cause.effect, 0.0)];
            list.extend_from_slice(&others);
            for rival in &mut list {
                rival.probability /= sum;
            }
            list
        });
        lists.collect()
    }
}

/// Leaves the nearest of each name.
fn merge_names(rivals: &mut Vec<Rival>) {
    let mut names: Vec<&str> = Vec::new();
    rivals.retain(|rival| {
        let is_new = !names.contains(&rival.name);
        names.push(rival.name);
        is_new
    });
}
