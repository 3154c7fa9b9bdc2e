//! What one hypothesis leaves less than another on unseen blocks, and whether that is beyond chance.

use haptical_linalg::sum_sd;

use crate::thresholds::payload::{LEAST_GAIN, LEAST_SHARE_OF_FOLDS, LEAST_T, MOST_RANKS_AGAINST};

/// What one hypothesis leaves less than another on unseen blocks.
#[derive(Debug, Clone, Copy)]
pub(in crate::force) struct Gain {
    /// In squares over the variance of a block.
    pub(in crate::force) sum: f64,
    /// Mean over folds, over its standard error.
    t: f64,
    /// Share of the folds that gain.
    share: f64,
    /// Sum of the ranks by size of those that do not.
    ranks_against: f64,
}

impl Gain {
    /// Of the gains fold by fold.
    pub(super) fn new(gains: &[f64]) -> Self {
        let count = gains.len().max(2) as f64;
        let (sum, sd) = (gains.iter().sum::<f64>(), sum_sd(gains));
        Self {
            sum,
            t: if sd > 0.0 { sum / sd } else { 0.0 },
            share: gains.iter().filter(|gain| **gain > 0.0).count() as f64 / count,
            ranks_against: ranks_against(gains),
        }
    }

    pub(in crate::force) fn is_beyond_chance(self) -> bool {
        self.is_had_by_most() && self.is_steady(LEAST_T)
    }

    /// The same of a law that was chosen among many by these blocks, whose ranks are no chance's: all folds gain, or by much
    /// more than they differ.
    pub(in crate::force) fn is_beyond_choice(self) -> bool {
        self.is_had_by_most() && (self.t >= LEAST_T || self.share >= 1.0)
    }

    fn is_had_by_most(self) -> bool {
        self.sum >= LEAST_GAIN && self.share >= LEAST_SHARE_OF_FOLDS
    }

    /// Whether the folds gain alike. A gain that differs much from one to the other has a large standard error, though only
    /// small ones are against it.
    pub(super) fn is_steady(self, least_t: f64) -> bool {
        self.t >= least_t || self.ranks_against <= MOST_RANKS_AGAINST
    }
}

/// Sum of the ranks, by size from 1, of the gains that are none (Wilcoxon 1945).
fn ranks_against(gains: &[f64]) -> f64 {
    let mut sorted = gains.to_vec();
    sorted.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let ranks = sorted.iter().zip(1_u32..);
    let against = ranks.filter(|(gain, _)| **gain <= 0.0);
    against.map(|(_, rank)| f64::from(rank)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_is_steady_by_its_error_or_by_its_ranks() {
        let steady = |gains: &[f64]| Gain::new(gains).is_beyond_chance();
        assert!(steady(&[10.0; 10]));
        // one fold has nearly all of it, and none is against it
        let mut gains = [5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 4000.0];
        assert!(steady(&gains));
        // two small ones are against it: ranks 1 and 2
        (gains[0], gains[1]) = (-5.0, -6.0);
        assert!(steady(&gains));
        // three are against it, or two of which one is large
        assert!(!steady(&[
            -5.0, -6.0, -7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 4000.0
        ]));
        gains[0] = -14.0;
        assert!(!steady(&gains));
        assert!(!steady(&[0.0; 10]) && !steady(&[1.0; 10]));
    }

    /// Of all signs that ten gains can have, the share that the ranks let pass is what the threshold says.
    #[test]
    fn chance_passes_the_ranks_once_in_146() {
        let passes = (0_u32..1024).filter(|signs| {
            let gain = |fold: u32| match signs >> fold & 1 {
                1 => -f64::from(fold + 1),
                _ => f64::from(fold + 1),
            };
            ranks_against(&(0..10).map(gain).collect::<Vec<_>>()) <= MOST_RANKS_AGAINST
        });
        assert_eq!(passes.count(), 7);
    }
}
