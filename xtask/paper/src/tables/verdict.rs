//! A published figure against this model and noise: possible or not.

use anyhow::Result;
use haptical_metrics::{normal_two_sided_p, rms};

/// Probability below which a single published error counts as impossible: with 43 rows and two
/// sides, less than one false verdict in ten reproductions.
const IMPOSSIBLE: f64 = 0.001;

/// The verdict on one published error.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Verdict {
    /// Published error over the standard deviation of ours.
    pub(crate) z: f64,
    pub(crate) words: &'static str,
    pub(crate) possible: bool,
}

impl Verdict {
    /// Judges a published error, known to half a printed digit, against the errors of our runs.
    pub(crate) fn new(published: f64, half_digit: f64, ours: &[f64]) -> Result<Self> {
        let sd = rms(ours)?;
        let z = published / sd;
        let beyond = normal_two_sided_p((published.abs() - half_digit).max(0.0) / sd)?;
        let within = 1.0 - normal_two_sided_p((published.abs() + half_digit) / sd)?;
        let (words, possible) = if beyond < IMPOSSIBLE {
            ("no: too far off", false)
        } else if within < IMPOSSIBLE {
            ("no: closer than noise allows", false)
        } else {
            ("yes", true)
        };
        Ok(Self { z, words, possible })
    }
}

#[cfg(test)]
mod tests {
    use super::Verdict;

    /// A standard normal sample by its quantiles: no luck involved.
    fn normal(sd: f64) -> Vec<f64> {
        (0..200)
            .map(|index| sd * if index % 2 == 0 { 1.0 } else { -1.0 })
            .collect()
    }

    #[test]
    fn an_error_of_one_standard_deviation_is_possible() {
        let verdict = Verdict::new(2.0, 0.01, &normal(2.0)).unwrap();
        assert!(verdict.possible && (verdict.z - 1.0).abs() < 1e-12);
    }

    #[test]
    fn four_standard_deviations_are_not() {
        assert_eq!(
            Verdict::new(-8.0, 0.01, &normal(2.0)).unwrap().words,
            "no: too far off"
        );
    }

    #[test]
    fn rounding_excuses_what_it_covers() {
        assert!(Verdict::new(8.0, 2.0, &normal(2.0)).unwrap().possible);
        assert!(Verdict::new(0.0, 0.01, &normal(2.0)).unwrap().possible);
        let verdict = Verdict::new(0.0, 1e-6, &normal(2.0)).unwrap();
        assert_eq!(verdict.words, "no: closer than noise allows");
    }
}
