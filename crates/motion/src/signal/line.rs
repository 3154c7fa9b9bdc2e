//! One frequency that holds most of what is faster than the motion: an oscillation, and no noise.

use std::f64::consts::TAU;

use haptical_linalg::dot;
use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use super::local_polynomial::LocalPolynomial;
use crate::thresholds::signal::{LINE_SAMPLES, LINE_SHARE};

/// An oscillation of a reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Frequency \[Hz\].
    pub hz: f64,
    /// Amplitude, in the reading's unit.
    pub amplitude: f64,
}

/// The line in what is left of a column next to a local polynomial: the frequency of the largest ordinate of its periodogram (Schuster 1898),
/// where that and its two neighbours hold most of the squares.
pub(crate) fn line(column: &[f64], local: &LocalPolynomial, step_s: f64) -> Option<Line> {
    let inner = local.half..column.len().saturating_sub(local.half);
    let rest: Vec<f64> = (inner.take(LINE_SAMPLES))
        .map(|at| column[at] - local.at(0, column, at))
        .collect();
    let count = rest.len();
    let whole = dot(&rest, &rest);
    if count < LINE_SAMPLES / 8 || whole <= 0.0 {
        return None;
    }
    let mut waves: Vec<Complex<f64>> = rest.iter().map(Complex::from).collect();
    FftPlanner::new()
        .plan_fft_forward(count)
        .process(&mut waves);
    let ordinates = waves[..=count / 2].iter();
    let ordinates: Vec<f64> = ordinates
        .map(|own| own.norm_sqr() * 2.0 / count as f64)
        .collect();
    let inner = 1..ordinates.len().saturating_sub(1);
    let highest = inner.max_by(|a, b| ordinates[*a].total_cmp(&ordinates[*b]))?;
    let held: f64 = ordinates[highest - 1..=highest + 1].iter().sum();
    let turn = TAU * highest as f64 / count as f64;
    (held > LINE_SHARE * whole).then(|| Line {
        hz: highest as f64 / (count as f64 * step_s),
        amplitude: (2.0 * held / count as f64).sqrt() / left_of_wave(local, turn),
    })
}

/// What the difference from a local polynomial leaves of a wave, by its turn from sample to sample \[rad\].
fn left_of_wave(local: &LocalPolynomial, turn: f64) -> f64 {
    let weights = local.weights[0].iter().enumerate();
    let passed =
        weights.map(|(at, weight)| weight * (turn * (at as f64 - local.half as f64)).cos());
    (1.0 - passed.sum::<f64>()).abs().max(f64::EPSILON)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    #[test]
    fn an_oscillation_is_found_and_noise_with_and_without_a_memory_is_none() {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let local = LocalPolynomial::new(0.005, 16.0);
        let mut memory = 0.0;
        let (mut white, mut red) = (Vec::new(), Vec::new());
        for _ in 0..3000 {
            let value: f64 = StandardNormal.sample(&mut random);
            memory = 0.9 * memory + value;
            white.push(value);
            red.push(memory);
        }
        assert_eq!(line(&white, &local, 0.005), None);
        assert_eq!(line(&red, &local, 0.005), None);
        let shaken: Vec<f64> = (white.iter().enumerate())
            .map(|(at, noise)| noise + 10.0 * (TAU * 31.3 * 0.005 * at as f64).sin())
            .collect();
        let found = line(&shaken, &local, 0.005).unwrap();
        assert!((found.hz - 31.3).abs() < 0.1, "{found:?}");
        assert!((found.amplitude / 10.0 - 1.0).abs() < 0.05, "{found:?}");
        // no larger than the noise: it is part of it
        let weak: Vec<f64> = (white.iter().enumerate())
            .map(|(at, noise)| noise + 0.5 * (TAU * 31.3 * 0.005 * at as f64).sin())
            .collect();
        assert_eq!(line(&weak, &local, 0.005), None);
    }
}
