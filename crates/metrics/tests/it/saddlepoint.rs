//! Quadratic forms against the saddlepoint formula where its equation has a solution in closed form.

use haptical_metrics::{MetricsError, normal_two_sided_p, quadratic_form_interval};

/// Sum of the roundings of a root of K' and of the normal tail.
const PROBABILITY: f64 = 1e-9;

/// P(Z <= z) from the two-sided tail.
fn normal_below(z: f64) -> f64 {
    let tail = 0.5 * normal_two_sided_p(z).unwrap();
    if z < 0.0 { tail } else { 1.0 - tail }
}

/// Kuonen (1999), eq. (3): P(Q <= q) from the saddlepoint s, K(s) and K''(s).
fn from_saddlepoint(q: f64, s: f64, generated: f64, curvature: f64) -> f64 {
    let w = s.signum() * (2.0 * (s * q - generated)).sqrt();
    let v = s * curvature.sqrt();
    normal_below(w + (v / w).ln() / w)
}

/// The same for `count` equal weights: 1 - 2 s w = n w / q.
fn equal_weights(weight: f64, count: f64, q: f64) -> f64 {
    let left = count * weight / q;
    let s = (1.0 - left) / (2.0 * weight);
    from_saddlepoint(q, s, -0.5 * count * left.ln(), 2.0 * q * q / count)
}

/// The same for two weights: K'(s) = q is a quadratic equation, its smaller root the one before the pole.
fn two_weights([a, b]: [f64; 2], q: f64) -> f64 {
    let (square, linear, constant) = (4.0 * a * b * q, 4.0 * a * b - 2.0 * q * (a + b), q - a - b);
    let root = (linear * linear - 4.0 * square * constant).sqrt();
    let s = (-linear - root) / (2.0 * square);
    let left = [1.0 - 2.0 * s * a, 1.0 - 2.0 * s * b];
    let generated = -0.5 * (left[0].ln() + left[1].ln());
    let curvature = 2.0 * ((a / left[0]).powi(2) + (b / left[1]).powi(2));
    from_saddlepoint(q, s, generated, curvature)
}

fn diagonal(entries: &[f64]) -> Vec<f64> {
    let mut matrix = vec![0.0; entries.len() * entries.len()];
    for (k, entry) in entries.iter().enumerate() {
        matrix[k * entries.len() + k] = *entry;
    }
    matrix
}

fn assert_near(found: f64, expected: f64) {
    assert!(
        (found - expected).abs() < PROBABILITY,
        "{found} / {expected}"
    );
}

#[test]
fn equal_weights_meet_the_formula_at_both_ends() {
    for size in [1, 2, 3, 8] {
        for scale in [1e-20, 6e-5, 1.0, 3e20] {
            let (covariance, form) = (
                diagonal(&vec![scale * 1e3; size]),
                diagonal(&vec![1e-3; size]),
            );
            for level in [0.2, 0.95, 0.9999] {
                let found = quadratic_form_interval(&covariance, &form, size, level).unwrap();
                let below = |q: f64| equal_weights(scale, size as f64, q);
                assert_near(below(found.low), 0.5 * (1.0 - level));
                assert_near(below(found.high), 0.5 * (1.0 + level));
            }
        }
    }
}

#[test]
fn unequal_weights_meet_the_formula_at_both_ends() {
    // the weights are the eigenvalues of C A: half the trace, plus and minus the root of its square less the
    // determinant
    let cases = [
        ([1.0, 0.0, 0.0, 1.0], [3.0, 0.0, 0.0, 1.0]),
        ([2.0, 1.0, 1.0, 2.0], [1.0, 0.0, 0.0, 1.0]),
        ([4.0, 0.0, 0.0, 9.0], [1.0, 0.5, 0.5, 2.0]),
        ([4.0, 2.0, 2.0, 9.0], [1.0, -0.5, -0.5, 2.0]),
        ([4e-6, 2e-2, 2e-2, 900.0], [1e5, -3.0, -3.0, 2e-3]),
        ([1.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 1e-6]),
    ];
    for (c, a) in cases {
        let half: f64 = 0.5 * (c[0] * a[0] + c[1] * a[2] + c[2] * a[1] + c[3] * a[3]);
        let determinant = (c[0] * c[3] - c[1] * c[2]) * (a[0] * a[3] - a[1] * a[2]);
        let root = (half * half - determinant).sqrt();
        let weights = [half + root, determinant / (half + root)];
        for level in [0.2, 0.95, 0.999] {
            let found = quadratic_form_interval(&c, &a, 2, level).unwrap();
            assert_near(two_weights(weights, found.low), 0.5 * (1.0 - level));
            assert_near(two_weights(weights, found.high), 0.5 * (1.0 + level));
        }
    }
}

#[test]
fn a_number_without_variance_adds_nothing() {
    let form = [1.0, 0.3, 0.3, 5.0];
    let one = quadratic_form_interval(&[4.0], &[1.0], 1, 0.95).unwrap();
    for covariance in [[4.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.8]] {
        let found = quadratic_form_interval(&covariance, &form, 2, 0.95).unwrap();
        assert!((found.low / one.low - 1.0).abs() < 1e-9, "{found:?}");
        assert!((found.high / one.high - 1.0).abs() < 1e-9, "{found:?}");
    }
}

/// At the mean the formula is 0 / 0 and tends to Phi(skewness / 6), with the skewness sqrt(8 / n) of a chi-square
/// variable; to first order that is 1/2 + skewness / (6 sqrt(2 pi)). Outside the two, ends lie where the formula says.
#[test]
fn ends_on_either_side_of_the_mean_meet_the_formula() {
    for size in [1, 2, 7] {
        let n = size as f64;
        let skewness = (8.0 / n).sqrt();
        let limit = normal_below(skewness / 6.0);
        let first_order = 0.5 + skewness / (6.0 * std::f64::consts::TAU.sqrt());
        for weight in [1e-9, 1.0, 1e9] {
            let (unit, form) = (diagonal(&vec![1.0; size]), diagonal(&vec![weight; size]));
            for (probability, is_above) in [(limit - 1e-3, false), (first_order + 1e-3, true)] {
                let level = 2.0 * probability - 1.0;
                let found = quadratic_form_interval(&unit, &form, size, level).unwrap();
                assert_eq!(found.high > n * weight, is_above, "{size}: {found:?}");
                assert_near(equal_weights(weight, n, found.high), probability);
            }
        }
    }
}

#[test]
fn matrices_of_another_size_are_named() {
    let unit = [1.0, 0.0, 0.0, 1.0];
    let refused = quadratic_form_interval(&unit, &[1.0; 3], 2, 0.95).unwrap_err();
    let expected = MetricsError::LengthMismatch {
        left: "the form",
        left_len: 3,
        right: "a square of this size",
        right_len: 4,
    };
    assert_eq!(refused, expected);
    let refused = quadratic_form_interval(&unit[..3], &unit, 2, 0.95).unwrap_err();
    assert!(matches!(
        refused,
        MetricsError::LengthMismatch {
            left: "the covariance",
            left_len: 3,
            right_len: 4,
            ..
        }
    ));
    let negative = quadratic_form_interval(&unit, &[-1.0, 0.0, 0.0, -1.0], 2, 0.95);
    assert!(matches!(negative, Err(MetricsError::OutOfRange { .. })));
}
