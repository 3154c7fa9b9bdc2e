//! Friction that is named although the torques show more than it: by what it says of blocks that its fit did not see.
//!
//! A real drive's friction has no single law, and an arm has cables and springs that no effect is. The same rule as for
//! positions (docs/diagnosis.md, "Partial causes"): a gain on unseen blocks that is beyond chance, no much larger one of a
//! free function of the joint's rate, and little left that depends on it.

use haptical_effects::{Effect, Family, Hook};

use super::base::Base;
use super::carried::Carried;
use super::changes::{Columns, Fitted, Folds, Pair, only};
use super::effects::Effects;
use super::select::Selection;
use crate::thresholds::payload::{FREE_BINS, LAW_OF_FREE, LEFT_TO_FREE};
use crate::thresholds::torque::DELAY_SD_S;

/// What unseen blocks say for some of the chosen effects.
#[derive(Debug, Clone)]
pub(super) struct Partial {
    /// Positions among the picks.
    pub(super) kept: Vec<usize>,
    /// Share of the squares beyond noise that they close.
    pub(super) closed_share: f64,
}

/// One pick's columns: by its law, and by a free function of its joint's rate.
struct Law {
    pick: usize,
    own: Vec<usize>,
    free: Vec<usize>,
}

fn is_friction(effect: &dyn Effect) -> bool {
    effect.spec().hook == Hook::Torque && effect.spec().family == Family::Loop
}

impl Effects<'_, '_> {
    /// The friction among the picks that unseen blocks support; none where they support none.
    pub(super) fn supported(
        &self,
        base: &Base,
        selection: &Selection,
        carried: &Carried,
    ) -> Option<Partial> {
        let along = self.along;
        let recorded = along.recorded;
        let channels: Vec<usize> = (0..recorded.channels.len()).collect();
        let mut columns = Columns::default();
        let pair = Pair::whole(
            along,
            carried
                .changes
                .payloads
                .iter()
                .map(|payload| &payload.torque_nm),
        );
        let blocks = recorded.blocks.len();
        let dense = |column: &[f64]| {
            column
                .chunks_exact(blocks)
                .map(|own| Some(own.to_vec()))
                .collect()
        };
        for column in &along.inertia {
            columns.add(dense(column), f64::INFINITY);
        }
        let geometry = along.geometry(&base.inertia, &along.force_n);
        for (column, sd) in geometry.iter().zip(along.geometry_sds()) {
            columns.add(dense(column), sd);
        }
        columns.add(
            dense(&along.delayed(&base.inertia, &along.force_n)),
            DELAY_SD_S,
        );
        for channel in &channels {
            let ones = only(channels.len(), *channel, vec![1.0; blocks]);
            columns.add(ones, f64::INFINITY);
        }
        let common: Vec<usize> = (0..columns.all.len()).collect();
        let mut laws = Vec::new();
        for (index, pick) in selection.picks.iter().enumerate() {
            let effect = self.effect(pick.effect);
            let Some(joint) = effect.joint().filter(|_| is_friction(effect)) else {
                continue;
            };
            let Some(channel) = recorded.channel(joint) else {
                continue;
            };
            let zero = vec![0.0; effect.spec().amplitudes];
            let signals = effect.derivative(recorded.context, &zero, pick.shape);
            let own = signals.iter().map(|signal| {
                let means = recorded.signal_means(signal);
                columns.add(dense(&means), f64::INFINITY)
            });
            let own = own.collect();
            let free = bins(&along.rates(joint))
                .into_iter()
                .map(|bin| columns.add(only(channels.len(), channel, bin), f64::INFINITY));
            laws.push(Law {
                pick: index,
                own,
                free: free.collect(),
            });
        }
        let noise: Vec<f64> = channels
            .iter()
            .map(|&channel| recorded.block_variance(channel))
            .collect();
        let folds = Folds::new(&columns, &pair, &noise);
        let with = |laws: &[&Law]| -> Fitted {
            let own = laws.iter().flat_map(|law| law.own.iter().copied());
            folds.fit(&common.iter().copied().chain(own).collect::<Vec<_>>())
        };
        let null = folds.fit(&common);
        let mut kept: Vec<&Law> = laws.iter().collect();
        loop {
            if kept.is_empty() {
                return None;
            }
            let all = with(&kept);
            let is_supported = |law: &&Law| {
                let others: Vec<&Law> = kept
                    .iter()
                    .copied()
                    .filter(|other| other.pick != law.pick)
                    .collect();
                let without = with(&others);
                let gain = all.gain_over(&without, &channels);
                let free = |more: &[usize]| {
                    let columns = without.columns.iter().chain(more).chain(&law.free);
                    folds.fit(&columns.copied().collect::<Vec<_>>())
                };
                let of_free = free(&[]).gain_over(&without, &channels).sum;
                let beyond = free(&law.own).gain_over(&all, &channels).sum;
                gain.is_beyond_chance()
                    && gain.sum >= LAW_OF_FREE * of_free
                    && beyond <= LEFT_TO_FREE * gain.sum
            };
            let supported: Vec<&Law> = kept.iter().copied().filter(is_supported).collect();
            if supported.len() == kept.len() {
                let beyond = |fitted: &Fitted| {
                    let noise = channels.iter().map(|&channel| {
                        folds.weight[channel] * noise[channel] * folds.rows(channel)
                    });
                    (fitted.left_on(&channels) - noise.sum::<f64>()).max(0.0)
                };
                return Some(Partial {
                    kept: kept.iter().map(|law| law.pick).collect(),
                    closed_share: (1.0 - beyond(&all) / beyond(&null).max(1e-300)).clamp(0.0, 1.0),
                });
            }
            kept = supported;
        }
    }
}

/// Which of some equally populated classes of a rate each block is in.
fn bins(rates: &[f64]) -> Vec<Vec<f64>> {
    let mut order: Vec<usize> = (0..rates.len()).collect();
    order.sort_by(|a, b| rates[*a].total_cmp(&rates[*b]));
    let mut bins = vec![vec![0.0; rates.len()]; FREE_BINS];
    for (place, block) in order.into_iter().enumerate() {
        bins[place * FREE_BINS / rates.len().max(1)][block] = 1.0;
    }
    bins
}
