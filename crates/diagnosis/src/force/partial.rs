//! Friction that is named although the torques show more than it: by what it says of blocks that its fit did not see.
//!
//! A real drive's friction has no single law, and an arm has cables and springs that no effect is. The same rule as for
//! positions (docs/diagnosis.md, "Partial causes"): a gain on unseen blocks that is beyond chance, no much larger one of a
//! free function of the joint's rate, and little left that depends on it.

use std::convert::Infallible;

use haptical_effects::{Family, Hook};
use haptical_judge::{Backward, Less, Needless, Without, without_needless};
use nalgebra::DVector;

use super::Model;
use super::changes::{Columns, Fitted, Folds, Pair, is_beyond_choice};
use crate::thresholds::payload::{FREE_BINS, LAW_OF_FREE, LEFT_TO_FREE};

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
    columns: Vec<usize>,
    free: Vec<usize>,
}

/// A comparison of laws on the blocks of a recording.
struct Comparison {
    laws: Vec<Law>,
    folds: Folds,
    common: Vec<usize>,
}

impl Comparison {
    fn with(&self, laws: &[usize]) -> Fitted {
        let of_laws = laws.iter().flat_map(|law| &self.laws[*law].columns);
        let columns: Vec<usize> = self.common.iter().chain(of_laws).copied().collect();
        self.folds.fit(&columns)
    }
}

impl Backward for Comparison {
    type State = Vec<usize>;
    type Error = Infallible;

    fn effects(&self, kept: &Vec<usize>) -> usize {
        kept.len()
    }

    fn without(&mut self, kept: &Vec<usize>, index: usize) -> Less<Self> {
        let mut others = kept.clone();
        others.remove(index);
        Ok(Without {
            worth: self.with(kept).gain_over(&self.with(&others), None).sum,
            state: others,
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
        let gain = with.gain_over(&without, None);
        let free = |more: &[usize]| {
            let columns = without.columns.iter().chain(more).chain(&law.free);
            self.folds.fit(&columns.copied().collect::<Vec<_>>())
        };
        let of_free = free(&[]).gain_over(&without, None).sum;
        let beyond = free(&law.columns).gain_over(&with, None).sum;
        let is_supported = is_beyond_choice(gain)
            && gain.sum >= LAW_OF_FREE * of_free
            && beyond <= LEFT_TO_FREE * gain.sum;
        Ok(!is_supported)
    }
}

impl Model<'_> {
    /// The friction among the picks that unseen blocks support; none where they support none.
    pub(super) fn supported(&self) -> Option<Partial> {
        let along = &self.effects.along;
        let recorded = &along.recorded;
        let pair = Pair::whole(along);
        // the rigid links with what is not exactly known of them, and a constant of each drive
        let mut columns = Columns::of_links(along, &self.base, &pair);
        let ones = vec![1.0; recorded.blocks.len()];
        for channel in 0..recorded.channels.len() {
            columns.add(recorded.on(channel, &ones), f64::INFINITY);
        }
        let common = (0..columns.len()).collect();
        let laws = self.laws(&mut columns);
        let noise = recorded.block_variances();
        let mut comparison = Comparison {
            folds: Folds::new(&columns, &pair, &noise),
            laws,
            common,
        };
        let every = (0..comparison.laws.len()).collect();
        let Ok(kept) = without_needless(&mut comparison, every, 0);
        let kept = kept.state;
        let fits = [&[], kept.as_slice()].map(|laws| comparison.with(laws));
        (!kept.is_empty()).then(|| Partial {
            closed_share: comparison.folds.closed(fits.each_ref(), &noise),
            kept: kept.iter().map(|law| comparison.laws[*law].pick).collect(),
        })
    }

    /// The friction among the picks, with columns of its own.
    fn laws(&self, columns: &mut Columns) -> Vec<Law> {
        let recorded = &self.effects.along.recorded;
        let mut laws = Vec::new();
        for (index, pick) in self.selection.picks.iter().enumerate() {
            let (effect, channel) = (
                self.effects.effect(pick.effect),
                self.effects.channel(pick.effect),
            );
            let is_friction =
                effect.spec().hook == Hook::Torque && effect.spec().family == Family::Loop;
            let Some(channel) = channel.filter(|_| is_friction) else {
                continue;
            };
            let zero = vec![0.0; effect.spec().amplitudes];
            let signals = effect.derivative(recorded.context, &zero, pick.shape);
            let rate = self.effects.along.rate.column(recorded.channels[channel]);
            let bins = bins(&rate.into_owned()).into_iter();
            let mut add = |column| columns.add(column, f64::INFINITY);
            laws.push(Law {
                pick: index,
                columns: signals
                    .iter()
                    .map(|signal| add(recorded.signal_means(signal)))
                    .collect(),
                free: bins.map(|bin| add(recorded.on(channel, &bin))).collect(),
            });
        }
        laws
    }
}

/// Which of some equally populated classes of a rate each block is in.
fn bins(rates: &DVector<f64>) -> Vec<Vec<f64>> {
    let mut order: Vec<usize> = (0..rates.len()).collect();
    order.sort_by(|a, b| rates[*a].total_cmp(&rates[*b]));
    let mut bins = vec![vec![0.0; rates.len()]; FREE_BINS];
    for (place, block) in order.into_iter().enumerate() {
        bins[place * FREE_BINS / rates.len().max(1)][block] = 1.0;
    }
    bins
}
