//! Excess over noise: energies of slow residuals against their degrees of freedom.

use crate::engine::system::SlowEnergy;
use crate::noise::{Noise, NoiseSource};
use crate::thresholds::selection::TAKEN_UP;

/// Slow residuals over what noise gives, at least 1.
pub(crate) fn misfit(energy: &[SlowEnergy]) -> f64 {
    let (sum, freedom) = energy.iter().fold((0.0, 0.0), |(sum, freedom), stream| {
        (sum + stream.energy, freedom + stream.freedom)
    });
    if freedom > 0.0 {
        (sum / freedom).max(1.0)
    } else {
        1.0
    }
}

/// Largest excess of a stream in standard deviations, the noise's own uncertainty allowed for.
pub(crate) fn worst_excess(energy: &[SlowEnergy], noise: &[Noise]) -> f64 {
    energy
        .iter()
        .zip(noise)
        .map(|(stream, noise)| {
            if stream.freedom <= 1.0 {
                return of_one_reading(*stream);
            }
            if noise.source == NoiseSource::Repeats {
                return over_repeats(*stream, noise);
            }
            let spread = (2.0 * stream.freedom)
                .sqrt()
                .hypot(stream.freedom * noise.uncertainty);
            stream.excess() / spread.max(1.0)
        })
        .fold(f64::NEG_INFINITY, f64::max)
}

/// Excess over a noise that repeats estimated, in standard deviations. The ratio of two mean squares is skew where one has
/// few degrees of freedom; its logarithm, of deviation sqrt(2 / n + 2 / m), is not (Fisher 1924).
fn over_repeats(stream: SlowEnergy, noise: &Noise) -> f64 {
    let ratio = (stream.energy / stream.freedom).max(1e-300);
    ratio.ln() / (2.0 / stream.freedom).sqrt().hypot(noise.uncertainty)
}

/// Excess of a single reading, such as the known distance of two sockets, in standard deviations: its square is
/// far from normal (Wilson & Hilferty 1931).
fn of_one_reading(stream: SlowEnergy) -> f64 {
    if stream.freedom <= TAKEN_UP {
        return f64::NEG_INFINITY;
    }
    let spread = 2.0 / (9.0 * stream.freedom);
    ((stream.energy / stream.freedom).max(0.0).cbrt() - (1.0 - spread)) / spread.sqrt()
}

/// Structured energy over all streams, and its standard deviation under noise.
pub(crate) fn excess(energy: &[SlowEnergy]) -> (f64, f64) {
    let sum = energy.iter().map(|stream| stream.excess()).sum();
    let variance: f64 = energy.iter().map(|stream| 2.0 * stream.freedom).sum();
    (sum, variance.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the F distribution: of 200 against 15 degrees of freedom, a ratio of 3.0 has the probability 0.01 by chance (a
    /// normal deviate of 2.4), one of 7.5 that of 3.5e-5 (4.0); SciPy's `f.sf`.
    #[test]
    fn a_ratio_over_few_repeats_is_no_more_than_the_f_distribution_says() {
        let noise = Noise {
            ratio: 1.0,
            colour: 0.0,
            coloured_share: 0.0,
            uncertainty: (2.0_f64 / 15.0).sqrt(),
            freedom: 15.0,
            source: NoiseSource::Repeats,
            speed_ratio: 1.0,
        };
        let excess = |ratio: f64| {
            let stream = SlowEnergy {
                energy: 200.0 * ratio,
                freedom: 200.0,
            };
            worst_excess(&[stream], std::slice::from_ref(&noise))
        };
        assert!(excess(1.0).abs() < 1e-12);
        assert!((2.0..3.2).contains(&excess(3.0)), "{}", excess(3.0));
        assert!((4.0..5.6).contains(&excess(7.5)), "{}", excess(7.5));
    }
}
