//! Quadratic forms against chi-square quantiles and against drawn numbers.

use haptical_metrics::quadratic_form_interval;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Sizes, and how far the saddlepoint approximation may be off: most at the lower end of one squared number, which
/// is a thousandth of its mean.
const SIZES: [(usize, f64); 5] = [(1, 0.16), (2, 0.03), (5, 0.01), (20, 0.002), (57, 0.002)];

fn unit(size: usize, scale: f64) -> Vec<f64> {
    let entry = |k: usize| {
        if usize::is_multiple_of(k, size + 1) {
            scale
        } else {
            0.0
        }
    };
    (0..size * size).map(entry).collect()
}

#[test]
fn equal_weights_are_a_chi_square() {
    for (size, tolerance) in SIZES {
        let (covariance, form) = (unit(size, 3e-10), unit(size, 2e5));
        let found = quadratic_form_interval(&covariance, &form, size, 0.95).unwrap();
        let chi_square = ChiSquared::new(size as f64).unwrap();
        for (end, probability) in [(found.low, 0.025), (found.high, 0.975)] {
            let expected = 6e-5 * chi_square.inverse_cdf(probability);
            assert!(
                (end / expected - 1.0).abs() < tolerance,
                "{size}: {end} {expected}"
            );
        }
    }
}

/// A sum of squares of three correlated numbers, drawn: the interval holds 95 % of them, as much missing on
/// either side.
#[test]
fn drawn_forms_lie_within() {
    let mut generator = ChaCha8Rng::seed_from_u64(5);
    let mut normal = || {
        let (u, v): (f64, f64) = (
            generator.random_range(1e-300..1.0),
            generator.random_range(0.0..1.0),
        );
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    };
    // x = F z, rows of very different units, the last a combination of the others: C has rank 2
    let f = [[1.0, 0.0], [3e-4, 4e-4], [1.0003, 4e-4]];
    let a = [[2.0, 10.0, 0.1], [10.0, 9e6, -5.0], [0.1, -5.0, 1.0]];
    let covariance: Vec<f64> = (0..9)
        .map(|k| (0..2).map(|j| f[k / 3][j] * f[k % 3][j]).sum())
        .collect();
    let form: Vec<f64> = a.iter().flatten().copied().collect();
    let interval = quadratic_form_interval(&covariance, &form, 3, 0.95).unwrap();
    let (mut low, mut high, count) = (0, 0, 40_000);
    for _ in 0..count {
        let z = [normal(), normal()];
        let x: Vec<f64> = f.iter().map(|row| row[0] * z[0] + row[1] * z[1]).collect();
        let q: f64 = (0..9).map(|k| x[k / 3] * a[k / 3][k % 3] * x[k % 3]).sum();
        low += u32::from(q < interval.low);
        high += u32::from(q > interval.high);
    }
    for missed in [low, high] {
        let share = f64::from(missed) / f64::from(count);
        assert!((0.022..0.028).contains(&share), "{share}");
    }
}

#[test]
fn forms_that_are_none_are_refused() {
    let unit = [1.0, 0.0, 0.0, 1.0];
    assert!(quadratic_form_interval(&unit, &unit, 3, 0.95).is_err());
    assert!(quadratic_form_interval(&unit, &unit, 2, 1.0).is_err());
    assert!(quadratic_form_interval(&unit, &[0.0; 4], 2, 0.95).is_err());
    assert!(quadratic_form_interval(&unit, &[f64::NAN; 4], 2, 0.95).is_err());
}
