//! The distribution of a sum of squares of correlated normal numbers.

use nalgebra::{DMatrix, SymmetricEigen};
use statrs::distribution::{ContinuousCDF, Normal};

use crate::error::{MetricsError, check_all_finite, check_level, check_range, check_same_length};
use crate::quantile::Interval;

/// Share of the largest weight below which a weight is rounding.
const SMALLEST_WEIGHT: f64 = 1e-12;
/// Halvings of a bracket: enough for every bit.
const HALVINGS: usize = 120;
/// Distance from the mean, in standard deviations, within which the approximation's 0 / 0 is replaced by its limit.
const NEAR_MEAN: f64 = 1e-4;

/// The central interval that holds x^T A x with probability `level`, for normal x of mean 0 and covariance C.
///
/// C and A are symmetric, `size` x `size`, row by row; C need not have full rank, A must not be negative. With the
/// eigenvalues w_i of C A the form is sum w_i z_i^2, z_i standard normal, whose distribution the saddlepoint
/// approximation gives: K(s) = -1/2 sum ln(1 - 2 s w_i), K'(s) = q, w = sign(s) sqrt(2 (s q - K)), v = s sqrt(K''),
/// P(Q > q) = 1 - Phi(w + ln(v / w) / w). Source: Kuonen, Saddlepoint approximations for distributions of quadratic
/// forms in normal variables, Biometrika 86, 1999.
///
/// # Errors
/// [`MetricsError::LengthMismatch`] where a matrix is not `size` x `size`, [`MetricsError::NonFinite`],
/// [`MetricsError::OutOfRange`] for a level outside 0 to 1 and a form that is zero.
///
/// # Examples
/// Two independent squares of unit size make an exponential number of mean 2:
/// ```
/// let unit = [1.0, 0.0, 0.0, 1.0];
/// let interval = haptical_metrics::quadratic_form_interval(&unit, &unit, 2, 0.95)?;
/// assert!((interval.low / (-2.0 * 0.975_f64.ln()) - 1.0).abs() < 0.03);
/// assert!((interval.high / (-2.0 * 0.025_f64.ln()) - 1.0).abs() < 0.03);
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn quadratic_form_interval(
    covariance: &[f64],
    form: &[f64],
    size: usize,
    level: f64,
) -> Result<Interval, MetricsError> {
    check_level(level)?;
    let weights = weights(covariance, form, size)?;
    Ok(Interval {
        low: quantile(&weights, 0.5 * (1.0 - level)),
        high: quantile(&weights, 0.5 * (1.0 + level)),
    })
}

/// Positive eigenvalues of C A, as those of F^T A F with C = F F^T.
fn weights(covariance: &[f64], form: &[f64], size: usize) -> Result<Vec<f64>, MetricsError> {
    for (left, matrix) in [("the covariance", covariance), ("the form", form)] {
        check_same_length((left, matrix.len()), ("a square of this size", size * size))?;
        check_all_finite(left, matrix)?;
    }
    // unit deviations first: metres and radians differ by orders of magnitude
    let deviation = |k: usize| covariance[k * size + k].max(0.0).sqrt();
    let scaled = DMatrix::from_fn(size, size, |a, b| {
        let scale = deviation(a) * deviation(b);
        if scale > 0.0 {
            0.5 * (covariance[a * size + b] + covariance[b * size + a]) / scale
        } else {
            0.0
        }
    });
    let middle = DMatrix::from_fn(size, size, |a, b| {
        0.5 * (form[a * size + b] + form[b * size + a]) * deviation(a) * deviation(b)
    });
    let mut factor = SymmetricEigen::new(scaled);
    let roots = factor.eigenvalues.map(|value| value.max(0.0).sqrt());
    for (mut column, root) in factor.eigenvectors.column_iter_mut().zip(roots.iter()) {
        column *= *root;
    }
    let product = factor.eigenvectors.transpose() * middle * &factor.eigenvectors;
    let weights = SymmetricEigen::new((&product + product.transpose()) * 0.5).eigenvalues;
    let largest = largest(weights.as_slice());
    let is_within = largest > 0.0 && largest.is_finite();
    let what = "the largest weight of the quadratic form";
    check_range(what, largest, is_within, "greater than 0")?;
    let kept = weights.iter().map(|weight| weight / largest);
    let kept = kept.filter(|weight| *weight > SMALLEST_WEIGHT);
    Ok(kept.map(|weight| weight * largest).collect())
}

fn largest(weights: &[f64]) -> f64 {
    weights.iter().copied().fold(0.0, f64::max)
}

/// The q with P(Q <= q) = `probability`, by bisection between 0 and an end that is above it.
fn quantile(weights: &[f64], probability: f64) -> f64 {
    let mut low = 0.0;
    let mut high: f64 = weights.iter().sum();
    for _ in 0..HALVINGS {
        if below(weights, high) > probability {
            break;
        }
        low = high;
        high *= 2.0;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if below(weights, middle) > probability {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}

/// P(Q <= q).
fn below(weights: &[f64], q: f64) -> f64 {
    let mean: f64 = weights.iter().sum();
    let variance: f64 = 2.0 * weights.iter().map(|weight| weight * weight).sum::<f64>();
    let normal = Normal::standard();
    if (q - mean).abs() < NEAR_MEAN * variance.sqrt() {
        // the limit of the formula below at the mean: ln(v / w) / w goes to skewness / 6 (Kuonen 1999)
        let third: f64 = 8.0 * weights.iter().map(|weight| weight.powi(3)).sum::<f64>();
        let skewness = third / variance.powf(1.5);
        return normal.cdf(skewness / 6.0);
    }
    // K' grows from 0 (s to minus infinity) to infinity at s = 1 / (2 largest)
    let slope = |s: f64| -> f64 { weights.iter().map(|w| w / (1.0 - 2.0 * s * w)).sum() };
    let mut high = 0.5 / largest(weights);
    let mut low = -high;
    while slope(low) > q && low > -1e280 {
        low *= 4.0;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if slope(middle) > q {
            high = middle;
        } else {
            low = middle;
        }
    }
    let s = 0.5 * (low + high);
    let generated: f64 = weights.iter().map(|w| -0.5 * (-2.0 * s * w).ln_1p()).sum();
    let curvature: f64 = weights
        .iter()
        .map(|w| 2.0 * (w / (1.0 - 2.0 * s * w)).powi(2))
        .sum();
    let w = s.signum() * (2.0 * (s * q - generated)).max(0.0).sqrt();
    let v = s * curvature.sqrt();
    if w == 0.0 || v == 0.0 {
        return 0.5;
    }
    normal.cdf(w + (v / w).ln() / w)
}

#[cfg(test)]
mod tests {
    use super::{NEAR_MEAN, below};

    #[test]
    fn the_distribution_has_no_step_at_the_mean() {
        for weights in [vec![1.0], vec![1.0, 0.3], vec![2.0, 2.0, 0.1]] {
            let mean: f64 = weights.iter().sum();
            let sd = (2.0 * weights.iter().map(|w| w * w).sum::<f64>()).sqrt();
            let at = |steps: f64| below(&weights, mean + steps * NEAR_MEAN * sd);
            let (inside, before, after) = (at(0.0), at(-1.5), at(1.5));
            assert!(
                before < inside && inside < after,
                "{before} {inside} {after}"
            );
            // its density is below 1 / sd
            assert!(after - before < 3.0 * NEAR_MEAN, "{before} {after}");
        }
    }
}
