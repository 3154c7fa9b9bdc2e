//! Noise of a joint's readings.

use crate::log::Series;

/// Noise of a sensor: the rounding to counts, or what neighbours scatter by, whichever is larger.
pub(crate) fn floor(series: &Series) -> f64 {
    // of a smooth motion the one or the other difference is smaller
    let second = scatter(series, &[1.0, -2.0, 1.0]);
    let third = scatter(series, &[1.0, -3.0, 3.0, -1.0]);
    second.min(third).max(rounding(series))
}

/// Deviation of the rounding to counts.
pub(crate) fn rounding(series: &Series) -> f64 {
    series.count / 12.0_f64.sqrt()
}

/// Deviation of white noise with the median size of a difference of neighbours that its weights give.
fn scatter(series: &Series, weights: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = series
        .pieces()
        .flat_map(|piece| series.response[piece].windows(weights.len()))
        .map(|own| {
            own.iter()
                .zip(weights)
                .map(|(a, b)| a * b)
                .sum::<f64>()
                .abs()
        })
        .collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    let gain = weights
        .iter()
        .map(|weight| weight * weight)
        .sum::<f64>()
        .sqrt();
    // a normal deviate's median size is 0.6745
    median / 0.6745 / gain
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::floor;
    use crate::log::{JointLog, Series};

    #[test]
    fn the_floor_is_the_standard_deviation_of_the_readings() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let time_s: Vec<f64> = (0..4000).map(|row| 0.01 * f64::from(row)).collect();
        let command: Vec<f64> = time_s.iter().map(|time| time.sin()).collect();
        // the sum of twelve even draws is nearly normal, with variance 1
        let mut normal = || (0..12).map(|_| random.random_range(-0.5..0.5)).sum::<f64>();
        let response: Vec<f64> = command.iter().map(|at| at + 0.003 * normal()).collect();
        let log = JointLog {
            time_s: Some(&time_s),
            command: Some(&command),
            response: &response,
            ..JointLog::default()
        };
        let found = floor(&Series::new(&log).unwrap());
        assert!((found / 0.003 - 1.0).abs() < 0.05, "{found}");
    }
}
