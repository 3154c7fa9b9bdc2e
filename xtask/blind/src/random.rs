//! Random numbers that mean the same on every machine: ChaCha8, and normal numbers through `libm`.

use std::f64::consts::TAU;

use rand::distr::OpenClosed01;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A named stream of random numbers.
#[derive(Debug, Clone)]
pub struct Random {
    generator: ChaCha8Rng,
    spare: Option<f64>,
}

impl Random {
    /// The stream `stream` of `seed`: streams of one seed are independent.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(stream);
        Self {
            generator,
            spare: None,
        }
    }

    /// A seed for another stream family.
    pub fn seed(&mut self) -> u64 {
        self.generator.random()
    }

    /// Uniform in (0, 1].
    pub fn unit(&mut self) -> f64 {
        self.generator.sample(OpenClosed01)
    }

    /// Uniform between `low` and `high`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Log-uniform over a factor of `spread` whose geometric middle is `middle`.
    pub fn around(&mut self, middle: f64, spread: f64) -> f64 {
        middle * libm::exp(self.uniform(-0.5, 0.5) * libm::log(spread))
    }

    /// Standard normal (Box & Muller, "A note on the generation of random normal deviates", 1958).
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = libm::sqrt(-2.0 * libm::log(self.unit()));
        let (sine, cosine) = libm::sincos(TAU * self.unit());
        self.spare = Some(radius * sine);
        radius * cosine
    }

    /// Normal, drawn again beyond `cut` standard deviations.
    pub fn normal_within(&mut self, cut: f64) -> f64 {
        loop {
            let value = self.normal();
            if value.abs() <= cut {
                return value;
            }
        }
    }

    /// An index below `count` (0 where `count` is 0).
    pub fn index(&mut self, count: usize) -> usize {
        let scaled = (1.0 - self.unit()) * count as f64;
        (scaled as usize).min(count.saturating_sub(1))
    }

    /// An entry of `choices`; `None` where there is none.
    pub fn choose<T: Copy>(&mut self, choices: &[T]) -> Option<T> {
        choices.get(self.index(choices.len())).copied()
    }

    /// -1 or 1.
    pub fn sign(&mut self) -> f64 {
        if self.unit() > 0.5 { 1.0 } else { -1.0 }
    }

    /// An angle in 0 .. 2 pi \[rad\].
    pub fn phase_rad(&mut self) -> f64 {
        self.uniform(0.0, TAU)
    }
}
