//! The exact binomial test and Holm's correction against closed forms and by simulation.

use haptical_metrics::{MetricsError, binomial_two_sided_p, holm_adjusted};
use proptest::prelude::*;

/// Sums of a few dozen terms of the mass function.
const ROUNDING: f64 = 1e-9;

/// C(n, k) p^k (1 - p)^(n - k) by the recursion in k, another route than the library's logarithms.
fn masses(n: usize, p: f64) -> Vec<f64> {
    let mut masses = vec![(1.0 - p).powi(n as i32)];
    for k in 1..=n {
        let last = masses[k - 1];
        masses.push(last * (n - k + 1) as f64 / k as f64 * p / (1.0 - p));
    }
    masses
}

#[test]
fn the_binomial_test_sums_what_is_no_likelier() {
    for (n, p) in [(20, 0.95), (24, 0.5), (60, 0.3), (100, 0.95)] {
        let masses = masses(n, p);
        for successes in 0..=n {
            let limit = masses[successes] * (1.0 + 1e-7);
            let expected: f64 = masses.iter().filter(|mass| **mass <= limit).sum();
            let found = binomial_two_sided_p(successes, n, p).unwrap();
            assert!(
                (found - expected).abs() < ROUNDING,
                "{successes} of {n}: {found} for {expected}"
            );
        }
    }
}

#[test]
fn counts_that_are_none_are_refused() {
    assert!(matches!(
        binomial_two_sided_p(0, 0, 0.5),
        Err(MetricsError::TooFew { .. })
    ));
    for (successes, n, p) in [
        (3, 2, 0.5),
        (1, 2, 0.0),
        (1, 2, f64::NAN),
        (1, 10_000_000, 0.5),
    ] {
        let refused = binomial_two_sided_p(successes, n, p);
        assert!(matches!(refused, Err(MetricsError::OutOfRange { .. })));
    }
    assert!(holm_adjusted(&[]).is_err());
    for bad in [-0.1, 1.1, f64::NAN] {
        assert!(holm_adjusted(&[0.5, bad]).is_err(), "{bad}");
    }
}

/// Holm (1979), section 3: the smallest against alpha / n, the next against alpha / (n - 1), until one is kept.
fn rejected_one_by_one(p_values: &[f64], alpha: f64) -> Vec<bool> {
    let mut rejected = vec![false; p_values.len()];
    loop {
        let left = rejected.iter().filter(|done| !**done).count();
        let next = (0..p_values.len())
            .filter(|&k| !rejected[k])
            .min_by(|&a, &b| p_values[a].total_cmp(&p_values[b]));
        match next {
            Some(k) if p_values[k] * left as f64 <= alpha => rejected[k] = true,
            _ => return rejected,
        }
    }
}

proptest! {
    #[test]
    fn holm_rejects_as_the_step_down_does(
        p_values in prop::collection::vec(0.0..=1.0_f64, 1..40), alpha in 0.001..0.5_f64
    ) {
        let small: Vec<f64> = p_values.iter().map(|p| p * p * p).collect();
        let adjusted = holm_adjusted(&small).unwrap();
        let expected = rejected_one_by_one(&small, alpha);
        for ((adjusted, p), expected) in adjusted.iter().zip(&small).zip(expected) {
            prop_assert_eq!(*adjusted <= alpha, expected);
            prop_assert!(adjusted >= p && *adjusted <= 1.0);
        }
    }
}
