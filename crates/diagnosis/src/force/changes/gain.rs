//! Whether what one hypothesis leaves less than another on unseen blocks is beyond chance.

use haptical_judge::Gain;

use crate::thresholds::payload::{LEAST_GAIN, LEAST_SHARE_OF_FOLDS, LEAST_T, MOST_RANKS_AGAINST};

/// Of two hypotheses that were not chosen by these blocks.
pub(in crate::force) fn is_beyond_chance(gain: Gain) -> bool {
    is_had_by_most(gain) && is_steady(gain, LEAST_T)
}

/// The same of a law that was chosen among many by these blocks, whose ranks are no chance's: all folds gain, or by much
/// more than they differ.
pub(in crate::force) fn is_beyond_choice(gain: Gain) -> bool {
    is_had_by_most(gain) && (gain.deviations() >= LEAST_T || gain.share_gaining() >= 1.0)
}

fn is_had_by_most(gain: Gain) -> bool {
    gain.sum >= LEAST_GAIN && gain.share_gaining() >= LEAST_SHARE_OF_FOLDS
}

/// Whether the folds gain alike. A gain that differs much from one to the other has a large standard error, though only
/// small ones are against it.
pub(super) fn is_steady(gain: Gain, least_t: f64) -> bool {
    gain.deviations() >= least_t || gain.ranks_against <= MOST_RANKS_AGAINST
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_is_steady_by_its_error_or_by_its_ranks() {
        let steady = |gains: &[f64]| is_beyond_chance(Gain::new(gains));
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
            Gain::new(&(0..10).map(gain).collect::<Vec<_>>()).ranks_against <= MOST_RANKS_AGAINST
        });
        assert_eq!(passes.count(), 7);
    }
}
