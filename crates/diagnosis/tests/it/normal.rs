//! Normal numbers for noise: the tests may not use the simulator's.

/// A stream of numbers of mean 0 and standard deviation 1.
#[derive(Debug)]
pub(crate) struct Normal {
    state: u64,
}

impl Normal {
    pub(crate) fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// A number evenly spread over 0 to 1 (splitmix64, Steele, Lea & Flood 2014).
    fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (((mixed ^ (mixed >> 31)) >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    /// The next number (Box & Muller 1958).
    pub(crate) fn next(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

#[test]
fn the_numbers_are_normal() {
    let mut normal = Normal::new(1);
    let numbers: Vec<f64> = (0..20_000).map(|_| normal.next()).collect();
    let moment = |power: i32| numbers.iter().map(|n| n.powi(power)).sum::<f64>() / 20_000.0;
    // standard deviations of the sample moments: 0.007, 0.010, 0.07
    assert!(
        moment(1).abs() < 0.03 && (moment(2) - 1.0).abs() < 0.04,
        "{} {}",
        moment(1),
        moment(2)
    );
    assert!((moment(4) - 3.0).abs() < 0.3, "{}", moment(4));
    let neighbours: f64 = numbers
        .windows(2)
        .map(|pair| pair[0] * pair[1])
        .sum::<f64>()
        / 20_000.0;
    assert!(neighbours.abs() < 0.03, "{neighbours}");
}
