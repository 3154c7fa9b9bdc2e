//! Friction of a bearing: Coulomb's on the side of the motion, viscous, and what Stribeck adds at low rates.

/// Rate within which friction is that of rest rather than of motion \[rad/s\].
const STRIBECK_RAD_PER_S: f64 = 0.1;
/// Share of the power that Coulomb's friction may seem to give back where it is hard to tell from viscous friction.
const GIVEN_BACK: f64 = 0.25;

/// The three columns, from the side (-1 to 1) and the rate at each row.
pub(crate) fn rubbing(side: Vec<f64>, rate: Vec<f64>) -> [Vec<f64>; 3] {
    let slow = |(side, rate): (&f64, &f64)| side * (-(rate / STRIBECK_RAD_PER_S).powi(2)).exp();
    let slow = side.iter().zip(&rate).map(slow).collect();
    [side, rate, slow]
}

/// Whether friction of this size takes energy over a motion.
pub(crate) fn takes_energy(rate: &[f64], amplitudes: &[f64]) -> bool {
    let count = rate.len().max(1) as f64;
    let mean = rate.iter().map(|rate| rate.abs()).sum::<f64>() / count;
    let square = rate.iter().map(|rate| rate * rate).sum::<f64>() / count;
    let power = amplitudes[0] * mean + amplitudes[1] * square;
    power > 0.0 && amplitudes[0] * mean > -GIVEN_BACK * power
}
