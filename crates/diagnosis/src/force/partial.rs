//! Friction that is named although the torques show more than it: by what it says of blocks that its fit did not see.
//!
//! A real drive's friction has no single law, and an arm has cables and springs that no effect is. The same rule as for
//! positions (docs/diagnosis.md, "Partial causes"): a gain on unseen blocks that is beyond chance, no much larger one of a
//! free function of the joint's rate, and little left that depends on it.

use std::convert::Infallible;

use haptical_effects::{Effect, Family, Hook};
use haptical_judge::{Backward, Needless, Without, without_needless};

use super::base::Base;
use super::changes::{Column, Columns, Fitted, Folds, Pair, is_beyond_choice, only};
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

/// A comparison of laws on the blocks of a recording.
struct Comparison {
    laws: Vec<Law>,
    folds: Folds,
    common: Vec<usize>,
    channels: Vec<usize>,
}

impl Comparison {
    fn with(&self, laws: &[usize]) -> Fitted {
        let own = laws
            .iter()
            .flat_map(|law| self.laws[*law].own.iter().copied());
        let columns: Vec<usize> = self.common.iter().copied().chain(own).collect();
        self.folds.fit(&columns)
    }
}

impl Backward for Comparison {
    type State = Vec<usize>;
    type Error = Infallible;

    fn effects(&self, kept: &Vec<usize>) -> usize {
        kept.len()
    }

    fn without(
        &mut self,
        kept: &Vec<usize>,
        index: usize,
    ) -> Result<Without<Vec<usize>>, Infallible> {
        let mut others = kept.clone();
        others.remove(index);
        let gain = (self.with(kept)).gain_over(&self.with(&others), &self.channels);
        Ok(Without {
            state: others,
            worth: gain.sum,
        })
    }
}

impl Needless for Comparison {
    /// Whether unseen blocks do not support a law, or a free function of the rate does much better.
    fn is_needless(
        &mut self,
        kept: &Vec<usize>,
        index: usize,
        all: &[Without<Vec<usize>>],
    ) -> Result<bool, Infallible> {
        let (law, with) = (&self.laws[kept[index]], self.with(kept));
        let without = self.with(&all[index].state);
        let gain = with.gain_over(&without, &self.channels);
        let free = |more: &[usize]| {
            let columns = without.columns.iter().chain(more).chain(&law.free);
            self.folds.fit(&columns.copied().collect::<Vec<_>>())
        };
        let of_free = free(&[]).gain_over(&without, &self.channels).sum;
        let beyond = free(&law.own).gain_over(&with, &self.channels).sum;
        let is_supported = is_beyond_choice(gain)
            && gain.sum >= LAW_OF_FREE * of_free
            && beyond <= LEFT_TO_FREE * gain.sum;
        Ok(!is_supported)
    }
}

impl Effects<'_, '_> {
    /// The friction among the picks that unseen blocks support; none where they support none.
    pub(super) fn supported(&self, base: &Base, selection: &Selection) -> Option<Partial> {
        let along = self.along;
        let recorded = along.recorded;
        let channels: Vec<usize> = (0..recorded.channels.len()).collect();
        let mut columns = self.of_base(base);
        let common: Vec<usize> = (0..columns.all.len()).collect();
        let noise: Vec<f64> = channels
            .iter()
            .map(|&channel| recorded.block_variance(channel))
            .collect();
        let pair = Pair::whole(along);
        let mut comparison = Comparison {
            laws: self.laws(selection, &mut columns),
            folds: Folds::new(&columns, &pair, &noise),
            common,
            channels,
        };
        let every = (0..comparison.laws.len()).collect();
        let Ok(kept) = without_needless(&mut comparison, every, 0);
        let Comparison {
            folds, channels, ..
        } = &comparison;
        let (all, null) = (comparison.with(&kept.state), comparison.with(&[]));
        let noise = folds.noise(channels, &noise);
        (!kept.state.is_empty()).then(|| Partial {
            kept: kept
                .state
                .iter()
                .map(|law| comparison.laws[*law].pick)
                .collect(),
            closed_share: all.closed_of(&null, channels, noise),
        })
    }

    /// The rigid links with what is not exactly known of them, and a constant of each drive.
    fn of_base(&self, base: &Base) -> Columns {
        let along = self.along;
        let channels = along.recorded.channels.len();
        let blocks = along.recorded.blocks.len();
        let mut columns = Columns::default();
        for column in &along.inertia {
            columns.add(dense(column, blocks), f64::INFINITY);
        }
        let geometry = along.geometry(&base.linearised_at, &along.force_n);
        for (column, sd) in geometry.iter().zip(along.geometry_sds()) {
            columns.add(dense(column, blocks), sd);
        }
        let delayed = along.delayed(&base.linearised_at, &along.force_n);
        columns.add(dense(&delayed, blocks), DELAY_SD_S);
        for channel in 0..channels {
            columns.add(only(channels, channel, vec![1.0; blocks]), f64::INFINITY);
        }
        columns
    }

    /// The friction among the picks, with columns of its own.
    fn laws(&self, selection: &Selection, columns: &mut Columns) -> Vec<Law> {
        let recorded = self.along.recorded;
        let blocks = recorded.blocks.len();
        let mut laws = Vec::new();
        for (index, pick) in selection.picks.iter().enumerate() {
            let effect = self.effect(pick.effect);
            let joint = effect.joint().filter(|_| is_friction(effect));
            let Some((joint, channel)) =
                joint.and_then(|joint| Some((joint, recorded.channel(joint)?)))
            else {
                continue;
            };
            let zero = vec![0.0; effect.spec().amplitudes];
            let signals = effect.derivative(recorded.context, &zero, pick.shape);
            let own = signals.iter().map(|signal| {
                let means = recorded.signal_means(signal);
                columns.add(dense(&means, blocks), f64::INFINITY)
            });
            let own = own.collect();
            let bins = bins(&self.along.rates(joint)).into_iter();
            let free = bins
                .map(|bin| columns.add(only(recorded.channels.len(), channel, bin), f64::INFINITY));
            laws.push(Law {
                pick: index,
                own,
                free: free.collect(),
            });
        }
        laws
    }
}

/// A column of all channels.
fn dense(column: &[f64], blocks: usize) -> Column {
    let channels = column.chunks_exact(blocks);
    channels.map(|own| Some(own.to_vec())).collect()
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
