//! Excess over noise: energies of slow residuals against their degrees of freedom.

use crate::engine::system::SlowEnergy;
use crate::noise::Noise;
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
            let spread = (2.0 * stream.freedom)
                .sqrt()
                .hypot(stream.freedom * noise.uncertainty);
            stream.excess() / spread.max(1.0)
        })
        .fold(f64::NEG_INFINITY, f64::max)
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
