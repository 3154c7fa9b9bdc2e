//! Noise of recorded columns, with its memory, from what is faster than the motion.

use haptical_linalg::dot;

use crate::signal::local_polynomial::LocalPolynomial;
use crate::thresholds::signal::{MEMORY_SDS, NOISE_CORRELATIONS, NOISE_ROUNDING, NOISE_SEGMENT};

/// A noise whose samples have a standard deviation and a correlation with the one before (an autoregression of the first order).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Noise {
    pub(crate) sd: f64,
    pub(crate) correlation: f64,
}

impl Noise {
    /// Of columns, by what is beside a local polynomial: medians over short segments, those left aside where a reading stands still to the
    /// last digit. Without `has_memory` it is white.
    pub(crate) fn of<'c>(
        columns: impl Iterator<Item = &'c [f64]>,
        local: &LocalPolynomial,
        has_memory: bool,
    ) -> Self {
        let mut squares = Vec::new();
        let mut ratios = Vec::new();
        for column in columns {
            let inner = local.half..column.len().saturating_sub(local.half);
            let rest: Vec<f64> = inner.map(|k| column[k] - local.at(0, column, k)).collect();
            let largest = column.iter().fold(0.0_f64, |most, own| most.max(own.abs()));
            for own in rest.chunks_exact(NOISE_SEGMENT) {
                let square = dot(own, own) / NOISE_SEGMENT as f64;
                if square > (NOISE_ROUNDING * largest).powi(2) {
                    squares.push(square);
                    let next = dot(&own[1..], own) / (NOISE_SEGMENT - 1) as f64;
                    ratios.push(next / square);
                }
            }
        }
        if squares.is_empty() {
            return Self {
                sd: 0.0,
                correlation: 0.0,
            };
        }
        // what is left of an autoregression beside the polynomial
        let mut left: Vec<f64> = local.weights[0].iter().map(|own| -own).collect();
        left[local.half] += 1.0;
        let spread = (1.25 / (NOISE_SEGMENT as f64 * ratios.len().max(1) as f64)).sqrt();
        let found = median(&mut ratios);
        let of = |step: usize| {
            let correlation = step as f64 / NOISE_CORRELATIONS as f64;
            (
                correlation,
                covariance(&left, correlation, 0),
                covariance(&left, correlation, 1),
            )
        };
        let white = of(0);
        let is_white = !has_memory || found <= white.2 / white.1 + MEMORY_SDS * spread;
        let off = |own: &(f64, f64, f64)| (own.2 / own.1 - found).abs();
        let (correlation, variance, _) = match is_white {
            true => white,
            false => (1..NOISE_CORRELATIONS).map(of).fold(white, |best, own| {
                if off(&own) < off(&best) { own } else { best }
            }),
        };
        // the median of a chi-square over its freedom (Wilson and Hilferty 1931)
        let bias = (1.0 - 2.0 / (9.0 * NOISE_SEGMENT as f64)).powi(3);
        let square = median(&mut squares) / bias;
        Self {
            sd: (square / variance.max(1e-6)).sqrt(),
            correlation,
        }
    }

    /// What weights leave of its standard deviation.
    pub(crate) fn behind(self, weights: &[f64]) -> f64 {
        self.sd * covariance(weights, self.correlation, 0).max(0.0).sqrt()
    }
}

/// Covariance at a lag of what weights make of an autoregression of variance 1.
fn covariance(weights: &[f64], correlation: f64, lag: usize) -> f64 {
    let mut sum = 0.0;
    for (a, first) in weights.iter().enumerate() {
        for (b, second) in weights.iter().enumerate() {
            let apart = (a + lag).abs_diff(b);
            // beyond this it is nothing
            if apart == 0 || correlation > 0.0 && apart < 200 {
                sum += first * second * correlation.powi(apart as i32);
            }
        }
    }
    sum
}

fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    let (_, median, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    *median
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::signal::low_pass::LowPass;

    /// A wave with a noise of a correlation and a standard deviation of 0.3.
    fn column(correlation: f64, seed: u64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut noise = 0.0;
        (0..6000)
            .map(|k| {
                let next: f64 = StandardNormal.sample(&mut random);
                noise = correlation * noise + (1.0 - correlation * correlation).sqrt() * next;
                5.0 * (0.02 * f64::from(k)).sin() + 0.3 * noise
            })
            .collect()
    }

    #[test]
    fn size_and_memory_of_a_noise_are_found_beside_a_motion() {
        let local = LocalPolynomial::new(0.005, 40.0);
        for correlation in [0.0, 0.3, 0.6] {
            let own = column(correlation, 3);
            let found = Noise::of([own.as_slice()].into_iter(), &local, true);
            assert!(
                (found.correlation - correlation).abs() < 0.12,
                "{correlation}: {found:?}"
            );
            assert!(
                (found.sd / 0.3 - 1.0).abs() < 0.15,
                "{correlation}: {found:?}"
            );
        }
    }

    #[test]
    fn counts_of_a_joint_that_mostly_rests_are_noise_while_it_moves() {
        let count = 1e-3;
        let position =
            |k: i32| (0.5 * f64::from(k.clamp(0, 1000)).powi(2) * 1e-5 / count).round() * count;
        let column: Vec<f64> = (-4000..4000).map(position).collect();
        let local = LocalPolynomial::new(0.005, 40.0);
        let found = Noise::of([column.as_slice()].into_iter(), &local, false);
        let wanted = count / 12.0_f64.sqrt();
        assert!((found.sd / wanted - 1.0).abs() < 0.2, "{found:?}, {wanted}");
    }

    #[test]
    fn a_memory_passes_a_low_pass_that_white_noise_does_not() {
        let (_, weights) = LowPass { edge_hz: 20.0 }.weights(0.005, 0.0);
        let of = |correlation| {
            Noise {
                sd: 1.0,
                correlation,
            }
            .behind(&weights)
        };
        assert!((of(0.0) - dot(&weights, &weights).sqrt()).abs() < 1e-12);
        // far below the noise's corner: the square root of (1 + c) / (1 - c)
        assert!(
            of(0.6) > 1.6 * of(0.0) && of(0.6) < 2.0 * of(0.0),
            "{}",
            of(0.6) / of(0.0)
        );
    }
}
