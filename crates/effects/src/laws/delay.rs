//! A channel that shows what was true a delay ago: x(t - delay) - x(t), to second order. The first order alone
//! leaves, at 4 ms and the accelerations of a hand, more than the noise of a cable encoder.

use crate::signal::LocalMotion;

/// -delay v + delay^2 a / 2.
pub(crate) fn moved(motion: &LocalMotion, delay_s: f64) -> Vec<f64> {
    let pairs = motion.velocity.iter().zip(&motion.acceleration);
    pairs
        .map(|(v, a)| delay_s * (0.5 * delay_s * a - v))
        .collect()
}

/// Its derivative with respect to the delay.
pub(crate) fn slope(motion: &LocalMotion, delay_s: f64) -> Vec<f64> {
    let pairs = motion.velocity.iter().zip(&motion.acceleration);
    pairs.map(|(v, a)| delay_s * a - v).collect()
}
