//! Position, velocity and acceleration from positions: a polynomial of degree 4 through the samples around each.
//!
//! Savitzky and Golay 1964; the band of the window is Schafer, IEEE Signal Processing Magazine 28(4), 2011, eq. (13).

use nalgebra::{DMatrix, DVector};

use crate::thresholds::signal::LOCAL_DEGREE;

/// Weights of the samples around one: their sums with positions are the polynomial's value and derivatives there.
#[derive(Debug, Clone)]
pub(crate) struct LocalPolynomial {
    /// Samples on each side.
    pub(crate) half: usize,
    /// Of position, velocity \[1/s\], acceleration \[1/s^2\] and the higher derivatives, each of 2 `half` + 1 samples.
    pub(crate) weights: [Vec<f64>; LOCAL_DEGREE + 1],
    pub(crate) step_s: f64,
}

impl LocalPolynomial {
    /// A window that passes what is slower than `cutoff_hz` (to -3 dB) of samples that are `step_s` apart.
    pub(crate) fn new(step_s: f64, cutoff_hz: f64) -> Self {
        let of_nyquist = 2.0 * cutoff_hz * step_s;
        let half = ((LOCAL_DEGREE as f64 + 1.0) / of_nyquist + 4.6) / 3.2;
        let half = (half.round() as usize).max(LOCAL_DEGREE / 2 + 1);
        let at = |index: usize| index as f64 - half as f64;
        let powers = DMatrix::from_fn(2 * half + 1, LOCAL_DEGREE + 1, |row, power| {
            (at(row) / half as f64).powi(power as i32)
        });
        let gram = powers.transpose() * &powers;
        let unit = step_s * half as f64;
        let weights = std::array::from_fn(|order| {
            let mut wanted = DVector::zeros(LOCAL_DEGREE + 1);
            // the derivative of x^k at 0 is k!
            let factorial: f64 = (1..=order).map(|k| k as f64).product();
            wanted[order] = factorial / unit.powi(order as i32);
            let solved = gram.clone().cholesky().map(|own| own.solve(&wanted));
            (&powers * solved.unwrap_or(wanted)).as_slice().to_vec()
        });
        Self {
            half,
            weights,
            step_s,
        }
    }

    /// The smoothed value at any sample of at least 2 `half` + 1: near an end, that of the last polynomial that has all its samples.
    pub(crate) fn smoothed(&self, samples: &[f64], index: usize) -> f64 {
        let centre = index.clamp(self.half, samples.len() - 1 - self.half);
        let ahead_s = (index as f64 - centre as f64) * self.step_s;
        // Taylor's series of the polynomial, by Horner's rule
        (0..=LOCAL_DEGREE).rev().fold(0.0, |sum, order| {
            self.at(order, samples, centre) + sum * ahead_s / (order + 1) as f64
        })
    }

    /// The value of a derivative at a sample that has `half` neighbours on each side.
    pub(crate) fn at(&self, order: usize, samples: &[f64], index: usize) -> f64 {
        let window = &samples[index - self.half..=index + self.half];
        haptical_linalg::dot(&self.weights[order], window)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_of_degree_four_is_itself_with_its_derivatives() {
        let local = LocalPolynomial::new(0.005, 40.0);
        let at = |t: f64| 0.3 - t + 2.0 * t * t - 30.0 * t.powi(3) + 400.0 * t.powi(4);
        let samples: Vec<f64> = (0..41).map(|k| at(0.005 * f64::from(k) - 0.1)).collect();
        for (index, t) in [(20, 0.0), (25, 0.025)] {
            let wanted = [
                at(t),
                -1.0 + 4.0 * t - 90.0 * t * t + 1600.0 * t.powi(3),
                4.0 - 180.0 * t + 4800.0 * t * t,
            ];
            for (order, wanted) in wanted.into_iter().enumerate() {
                let found = local.at(order, &samples, index);
                assert!((found - wanted).abs() < 1e-8, "{order}: {found}, {wanted}");
            }
        }
        for index in [0, 1, 20, 40] {
            let (found, wanted) = (local.smoothed(&samples, index), samples[index]);
            assert!((found - wanted).abs() < 1e-8, "{index}: {found}, {wanted}");
        }
    }

    #[test]
    fn the_band_is_what_was_asked_for() {
        let (step_s, cutoff_hz) = (0.001, 40.0);
        let local = LocalPolynomial::new(step_s, cutoff_hz);
        let gain = |hz: f64| {
            let phase = |k: usize| {
                let t = step_s * (k as f64 - local.half as f64);
                (core::f64::consts::TAU * hz * t).cos()
            };
            let terms = local.weights[0].iter().enumerate();
            terms.map(|(k, weight)| weight * phase(k)).sum::<f64>()
        };
        assert!(
            (gain(cutoff_hz) - 0.5_f64.sqrt()).abs() < 0.05,
            "{}",
            gain(cutoff_hz)
        );
        assert!((gain(10.0) - 1.0).abs() < 0.002, "{}", gain(10.0));
    }
}
