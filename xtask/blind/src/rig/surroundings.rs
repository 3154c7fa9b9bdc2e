//! Loads on a device during a recording: the force of the hand, and its own warming.

use crate::random::Random;
use crate::rig::motion::MotionPlan;

/// Temperature of the device \[degC\], row by row: an exponential rise of 8 to 10 K from about 22 degC, or the rest of it from
/// `warm_degc`, to which the device was warmed up to a third of a kelvin. The second number is the temperature of a cold start.
pub(crate) fn temperature_degc(
    rows: usize,
    plan: &MotionPlan,
    warm_degc: Option<f64>,
    random: &mut Random,
) -> (Vec<f64>, f64) {
    let (mut rise_k, time_s) = (random.uniform(8.0, 10.0), random.uniform(32.0, 42.0));
    let cold_degc = 22.0 + 0.3 * random.normal();
    let mut start_degc = cold_degc;
    if let Some(warm_degc) = warm_degc {
        let warm_degc = warm_degc + 0.3 * random.normal();
        (start_degc, rise_k) = (warm_degc, start_degc + rise_k - warm_degc);
    }
    let course = (0..rows).map(|row| {
        let since_start_s = row as f64 / plan.rate_hz;
        start_degc - rise_k * libm::expm1(-since_start_s / time_s)
    });
    (course.collect(), cold_degc)
}

/// Smooth random force of a hand: sums of slow sines, 0.56 N in each direction, at most about 2 N.
pub(crate) fn hand_force(rows: usize, plan: &MotionPlan, random: &mut Random) -> Vec<[f64; 3]> {
    const WAVES: usize = 7;
    const WAVE_SD_N: f64 = 0.56;
    let waves: [[[f64; 3]; WAVES]; 3] = std::array::from_fn(|_| {
        std::array::from_fn(|_| {
            let frequency_hz = random.uniform(0.05, 1.6);
            [
                std::f64::consts::TAU * frequency_hz,
                random.phase_rad(),
                WAVE_SD_N * libm::sqrt(2.0 / WAVES as f64),
            ]
        })
    });
    (0..rows)
        .map(|row| {
            let time_s = row as f64 / plan.rate_hz;
            waves.each_ref().map(|axis| {
                axis.iter()
                    .map(|[rate, phase, size]| plan.hand * size * libm::sin(rate * time_s + phase))
                    .sum()
            })
        })
        .collect()
}
