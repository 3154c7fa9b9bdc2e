//! The orthonormal discrete cosine transform (type 2) of any length.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use haptical_metrics::{Complex, Fourier};

/// y_k = c_k sum_n x_n cos(pi (n + 1/2) k / N), c_0 = sqrt(1/N), else sqrt(2/N): by one Fourier transform of the entries with
/// even places, then those with odd places backwards (Makhoul 1980, "A fast cosine transform in one and two dimensions").
pub(super) struct Cosines {
    fourier: Fourier,
    turns: Vec<Complex<f64>>,
}

impl Cosines {
    pub(super) fn new(count: usize) -> Self {
        let scale = (2.0 / count as f64).sqrt();
        let mut turns: Vec<Complex<f64>> = (0..count)
            .map(|mode| Complex::from_polar(scale, -0.5 * PI * mode as f64 / count as f64))
            .collect();
        if let Some(first) = turns.first_mut() {
            *first *= FRAC_1_SQRT_2;
        }
        Self {
            fourier: Fourier::new(count),
            turns,
        }
    }

    /// Transforms as many values as it was made for.
    pub(super) fn apply(&mut self, values: &mut [f64]) {
        let even = values.iter().step_by(2);
        let odd = values.iter().skip(1).step_by(2).rev();
        let found = self.fourier.transform(even.chain(odd).copied());
        for (value, (entry, turn)) in values.iter_mut().zip(found.iter().zip(&self.turns)) {
            *value = entry.re * turn.re - entry.im * turn.im;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the sum itself: lengths even, odd, prime and of one.
    #[test]
    fn the_transform_is_its_sum() {
        for count in [1, 2, 5, 12, 97] {
            let values: Vec<f64> = (0..count).map(|n| (1.7 * (n * n) as f64).sin()).collect();
            let mut transformed = values.clone();
            let mut transform = Cosines::new(count);
            for _ in 0..2 {
                transformed.copy_from_slice(&values);
                transform.apply(&mut transformed);
            }
            for (mode, found) in transformed.iter().enumerate() {
                let terms = values.iter().enumerate().map(|(n, value)| {
                    value * (PI * (n as f64 + 0.5) * mode as f64 / count as f64).cos()
                });
                let scale = if mode == 0 { 1.0 } else { 2.0 } / count as f64;
                let sum = scale.sqrt() * terms.sum::<f64>();
                assert!(
                    (found - sum).abs() < 1e-13,
                    "{count}, {mode}: {found} for {sum}"
                );
            }
        }
    }
}
