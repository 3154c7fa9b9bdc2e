//! Smooth random functions: sums of sines whose frequencies fill a band.

use std::f64::consts::TAU;

use rand_chacha::ChaCha8Rng;

use crate::streams::uniform;

/// A random function of one variable without mean, band-limited and as smooth as a sine.
#[derive(Debug, Clone, Default)]
pub(crate) struct Waves {
    /// Angular frequency and phase of each sine.
    sines: Vec<[f64; 2]>,
    amplitude: f64,
}

impl Waves {
    /// `count` sines of equal amplitude, one angular frequency in each equal part of `band`. The root
    /// mean square over a long stretch is `rms`: that of a sine is its amplitude over sqrt 2, and
    /// squares of different frequencies add.
    pub(crate) fn new(mut generator: ChaCha8Rng, count: usize, band: [f64; 2], rms: f64) -> Self {
        let step = (band[1] - band[0]) / count as f64;
        let sines = (0..count)
            .map(|index| {
                let frequency = band[0] + step * (index as f64 + uniform(&mut generator));
                [frequency, TAU * uniform(&mut generator)]
            })
            .collect();
        Self {
            sines,
            amplitude: rms * libm::sqrt(2.0 / count as f64),
        }
    }

    /// Value at `x`.
    pub(crate) fn value(&self, x: f64) -> f64 {
        let sum: f64 = self
            .sines
            .iter()
            .map(|[frequency, phase]| libm::sin(frequency * x + phase))
            .sum();
        self.amplitude * sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::streams::Stream;

    #[test]
    fn the_root_mean_square_and_the_band_are_the_given_ones() {
        let waves = Waves::new(Stream::Roughness.open(0, 3), 32, [100.0, 1000.0], 0.25);
        assert!(
            waves
                .sines
                .iter()
                .all(|[w, _]| (100.0..=1000.0).contains(w))
        );
        // 100 rad hold 1600 periods of the slowest sine; mixed products average out as 1 / 100
        let samples = 100_000;
        let square: f64 = (0..samples)
            .map(|k| waves.value(f64::from(k) * 1e-3).powi(2))
            .sum::<f64>()
            / f64::from(samples);
        assert!(
            (square.sqrt() / 0.25 - 1.0).abs() < 0.02,
            "{}",
            square.sqrt()
        );
    }
}
