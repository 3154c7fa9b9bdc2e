//! SplitMix64 (Steele, Lea & Flood 2014): numbers for tests, the same on every machine.

/// A stream of numbers that depends on its seed alone.
///
/// ```
/// use haptical_testkit::Random;
///
/// let mut numbers = Random::new(7);
/// let uniform = numbers.uniform();
/// assert!((0.0..1.0).contains(&uniform));
/// assert_eq!(Random::new(7).uniform(), uniform);
/// ```
#[derive(Debug, Clone)]
pub struct Random {
    state: u64,
}

/// The generator's increment, 2^64 over the golden ratio.
const INCREMENT: u64 = 0x9e37_79b9_7f4a_7c15;

impl Random {
    /// The stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(INCREMENT);
        let mut mixed = self.state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// A number in \[0, 1).
    pub fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number in \[-1, 1).
    pub fn spread(&mut self) -> f64 {
        2.0 * self.uniform() - 1.0
    }

    /// A normal number of mean 0 and standard deviation 1 (Box & Muller 1958).
    pub fn normal(&mut self) -> f64 {
        // 1 - u is in (0, 1], so the logarithm is finite
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COUNT: usize = 20_000;

    /// The first numbers of seed 1234567, published with the reference implementation (Vigna, splitmix64.c).
    #[test]
    fn the_bits_are_the_reference_s() {
        let mut numbers = Random::new(1_234_567);
        let expected = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
        ];
        assert_eq!(expected.map(|_| numbers.bits()), expected);
    }

    #[test]
    fn normal_numbers_have_the_moments_of_the_distribution() {
        let mut random = Random::new(1);
        let numbers: Vec<f64> = (0..COUNT).map(|_| random.normal()).collect();
        let mean =
            |of: &dyn Fn(f64) -> f64| numbers.iter().map(|&n| of(n)).sum::<f64>() / COUNT as f64;
        // standard deviations of the sample moments: 0.007, 0.010, 0.07; the bounds are four of them
        assert!(mean(&|n| n).abs() < 0.03);
        assert!((mean(&|n| n * n) - 1.0).abs() < 0.04);
        assert!((mean(&|n| n.powi(4)) - 3.0).abs() < 0.3);
        let neighbours: f64 = numbers.windows(2).map(|pair| pair[0] * pair[1]).sum();
        assert!((neighbours / COUNT as f64).abs() < 0.03);
    }
}
