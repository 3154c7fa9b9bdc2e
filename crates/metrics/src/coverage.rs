//! Tests of counted successes against a stated probability, for one count and for many at once.

use statrs::distribution::{Binomial, Discrete};

use crate::error::{MetricsError, check_count, check_level, check_range, check_values};

/// Relative difference of two probabilities that counts as rounding, so that the mirror image of a
/// count is as likely as the count (R's `binom.test` takes the same).
const SAME_PROBABILITY: f64 = 1e-7;

/// Most trials that are summed over one by one.
const MOST_TRIALS: usize = 1_000_000;

/// Exact two-sided binomial test: the probability of a count that is no likelier than `successes` in `n`
/// trials, each a success with `probability`.
///
/// A small result says that intervals which state `probability` do not hold it: too few hits, or too many.
/// Source: the method of small probabilities, Hirji, *Exact Analysis of Discrete Data*, 2006, section 4.
///
/// # Errors
/// [`MetricsError::TooFew`] for `n` 0, [`MetricsError::OutOfRange`] for more successes than trials, more
/// than a million trials or a probability outside 0 to 1 (both excluded).
///
/// # Examples
/// Nine or ten, none or one heads of ten throws: 22 of 1024 cases.
/// ```
/// let p = haptical_metrics::binomial_two_sided_p(9, 10, 0.5)?;
/// assert!((p - 22.0 / 1024.0).abs() < 1e-12);
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn binomial_two_sided_p(
    successes: usize,
    n: usize,
    probability: f64,
) -> Result<f64, MetricsError> {
    check_level(probability)?;
    check_trials(successes, n)?;
    check_range("trials", n as f64, n <= MOST_TRIALS, "at most 1000000")?;
    let distribution =
        Binomial::new(probability, n as u64).map_err(|_| MetricsError::OutOfRange {
            what: "probability",
            got: probability,
            allowed: "between 0 and 1, both excluded",
        })?;
    let limit = distribution.pmf(successes as u64) * (1.0 + SAME_PROBABILITY);
    let sum: f64 = (0..=n as u64)
        .map(|count| distribution.pmf(count))
        .filter(|mass| *mass <= limit)
        .sum();
    Ok(sum.clamp(0.0, 1.0))
}

/// Refuses counts of which no share can be taken.
pub(crate) fn check_trials(successes: usize, n: usize) -> Result<(), MetricsError> {
    check_count("the trials", n, 1)?;
    let allowed = "at most the number of trials";
    check_range("successes", successes as f64, successes <= n, allowed)
}

/// Holm's adjusted p-values: rejecting those below alpha rejects a true hypothesis among all of them with
/// a probability of at most alpha, whatever their dependence.
///
/// With the p-values in ascending order p_(1) .. p_(n), the k-th becomes max_(j <= k) min(1, (n - j + 1) p_(j)).
/// The result is in the order of the argument. Source: Holm, A simple sequentially rejective multiple test
/// procedure, Scandinavian Journal of Statistics 6, 1979.
///
/// # Errors
/// [`MetricsError::TooFew`] for no values, [`MetricsError::NonFinite`], [`MetricsError::OutOfRange`] for a value
/// outside 0 to 1.
///
/// # Examples
/// ```
/// let adjusted = haptical_metrics::holm_adjusted(&[0.02, 0.5, 0.01])?;
/// assert_eq!(adjusted, [0.04, 0.5, 0.03]);
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn holm_adjusted(p_values: &[f64]) -> Result<Vec<f64>, MetricsError> {
    check_values("the p-values", p_values, 1)?;
    for &p in p_values {
        check_range("a p-value", p, (0.0..=1.0).contains(&p), "from 0 to 1")?;
    }
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|&a, &b| p_values[a].total_cmp(&p_values[b]));
    let mut adjusted = vec![0.0; p_values.len()];
    let mut largest = 0.0_f64;
    for (rank, &index) in order.iter().enumerate() {
        let left = (p_values.len() - rank) as f64;
        largest = largest.max((left * p_values[index]).min(1.0));
        adjusted[index] = largest;
    }
    Ok(adjusted)
}
