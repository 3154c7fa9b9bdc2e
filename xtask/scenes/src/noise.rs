//! Random numbers of scenes: normal, with `libm`'s functions, so that a seed means the same log on every machine.

use haptical_testkit::Random;

/// A stream of normal numbers.
#[derive(Debug, Clone)]
pub(crate) struct Noise {
    random: Random,
}

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        Self {
            random: Random::new(seed),
        }
    }

    /// Uniform between two ends.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.random.uniform()
    }

    /// Normal with mean 0 (Box & Muller 1958).
    pub(crate) fn normal(&mut self, sd: f64) -> f64 {
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - self.random.uniform()));
        sd * radius * libm::cos(std::f64::consts::TAU * self.random.uniform())
    }

    /// Normal numbers, each correlated with the one before.
    pub(crate) fn with_memory(&mut self, rows: usize, sd: f64, memory: f64) -> Vec<f64> {
        let fresh = sd * (1.0 - memory * memory).sqrt();
        let mut last = self.normal(sd);
        let next = |_| {
            last = memory * last + self.normal(fresh);
            last
        };
        (0..rows).map(next).collect()
    }
}
