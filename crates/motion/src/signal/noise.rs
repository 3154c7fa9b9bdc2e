//! Noise of recorded columns, from what is faster than the motion.

use haptical_linalg::dot;

use crate::signal::local_polynomial::LocalPolynomial;
use crate::thresholds::signal::{
    LEAST_NOISE_SEGMENT, NOISE_ROUNDING, NOISE_SEGMENT, NOISE_SEGMENT_S, NOISE_SEGMENTS,
};

/// A noise of two parts, one white and one with a memory, an autoregression of the first order.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Noise {
    /// Standard deviation of the white part, in the reading's unit.
    pub sd: f64,
    /// And of the part with a memory.
    pub memory_sd: f64,
    /// Correlation of the latter's successive samples.
    pub correlation: f64,
}

impl Noise {
    /// Of columns whose noise is white, by what is next to a local polynomial: medians over short segments, those left aside where a reading
    /// stands still to the last digit.
    pub(crate) fn white<'c>(
        columns: impl Iterator<Item = &'c [f64]> + Clone,
        local: &LocalPolynomial,
    ) -> Self {
        let segment = (NOISE_SEGMENT_S / local.step_s).round() as usize;
        let segment = segment.clamp(LEAST_NOISE_SEGMENT, NOISE_SEGMENT);
        let inner = |column: &[f64]| column.len().saturating_sub(2 * local.half);
        let segments: usize = columns.clone().map(|own| inner(own) / segment).sum();
        let every = segments.div_ceil(NOISE_SEGMENTS).max(1);
        let mut squares = Vec::new();
        // segments of the columns before
        let mut before = 0_usize;
        for column in columns {
            let largest = column.iter().fold(0.0_f64, |most, own| most.max(own.abs()));
            let own = inner(column) / segment;
            let first = before.next_multiple_of(every) - before;
            before += own;
            for number in (first..own).step_by(every) {
                let first = local.half + number * segment;
                let rows = first..first + segment;
                let own: Vec<f64> = rows.map(|k| column[k] - local.at(0, column, k)).collect();
                let square = dot(&own, &own) / segment as f64;
                if square > (NOISE_ROUNDING * largest).powi(2) {
                    squares.push(square);
                }
            }
        }
        // what is left of a white noise next to the polynomial
        let left = 1.0 - local.weights[0][local.half];
        // the median of a chi-square over its freedom (Wilson and Hilferty 1931)
        let bias = (1.0 - 2.0 / (9.0 * segment as f64)).powi(3);
        let square = median(&mut squares) / bias;
        Self {
            sd: (square / left.max(1e-6)).sqrt(),
            ..Self::default()
        }
    }

    /// What weights leave of its standard deviation.
    pub(crate) fn behind(self, weights: &[f64]) -> f64 {
        let white = self.sd * self.sd * dot(weights, weights);
        let memory = match self.memory_sd > 0.0 {
            true => self.memory_sd.powi(2) * covariance(weights, self.correlation),
            false => 0.0,
        };
        (white + memory).max(0.0).sqrt()
    }
}

/// Variance of what weights make of an autoregression of variance 1.
fn covariance(weights: &[f64], correlation: f64) -> f64 {
    let mut sum = 0.0;
    for (a, first) in weights.iter().enumerate() {
        // sums of the neighbours to one side
        let (mut fades, mut beyond) = (1.0, 0.0);
        for second in &weights[a + 1..] {
            fades *= correlation;
            beyond += second * fades;
        }
        sum += first * (first + 2.0 * beyond);
    }
    sum
}

pub(super) fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    let (_, median, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    *median
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::signal::low_pass::LowPass;

    /// A wave with a noise of a correlation and a standard deviation of 0.3.
    fn column(correlation: f64, seed: u64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut noise = 0.0;
        (0..6000)
            .map(|k| {
                let next: f64 = StandardNormal.sample(&mut random);
                noise = correlation * noise + (1.0 - correlation * correlation).sqrt() * next;
                5.0 * (0.02 * f64::from(k)).sin() + 0.3 * noise
            })
            .collect()
    }

    #[test]
    fn the_size_of_a_white_noise_is_found_next_to_a_motion() {
        let local = LocalPolynomial::new(0.005, 40.0);
        let own = column(0.0, 3);
        let found = Noise::white([own.as_slice()].into_iter(), &local);
        assert!((found.sd / 0.3 - 1.0).abs() < 0.15, "{found:?}");
    }

    #[test]
    fn counts_of_a_joint_that_mostly_rests_are_noise_while_it_moves() {
        let count = 1e-3;
        let position =
            |k: i32| (0.5 * f64::from(k.clamp(0, 1000)).powi(2) * 1e-5 / count).round() * count;
        let column: Vec<f64> = (-4000..4000).map(position).collect();
        let local = LocalPolynomial::new(0.005, 40.0);
        let found = Noise::white([column.as_slice()].into_iter(), &local);
        let wanted = count / 12.0_f64.sqrt();
        assert!((found.sd / wanted - 1.0).abs() < 0.2, "{found:?}, {wanted}");
    }

    #[test]
    fn a_memory_passes_a_low_pass_that_white_noise_does_not() {
        let (_, weights) = LowPass { edge_hz: 20.0 }.weights(0.005, 0.0);
        let of = |correlation| {
            Noise {
                sd: 0.0,
                memory_sd: 1.0,
                correlation,
            }
            .behind(&weights)
        };
        assert!((of(0.0) - dot(&weights, &weights).sqrt()).abs() < 1e-12);
        // far below the noise's corner: the square root of (1 + c) / (1 - c)
        assert!(
            of(0.6) > 1.6 * of(0.0) && of(0.6) < 2.0 * of(0.0),
            "{}",
            of(0.6) / of(0.0)
        );
    }
}
