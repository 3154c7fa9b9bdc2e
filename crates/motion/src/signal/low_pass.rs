//! The low pass that torques and what explains them go through alike, and the rows that are kept behind it.
//!
//! A sinc under a Hann window (Oppenheim and Schafer, Discrete-Time Signal Processing, ch. 7.5), centred where the row is, so
//! that it has no phase, and cut where it ends, so that nothing starts up. Its rows are half a period of the band's edge
//! apart, where a white noise behind it is white still.

use core::f64::consts::PI;

use crate::thresholds::signal::LOW_PASS_PERIODS;

/// A low pass of a band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LowPass {
    /// Edge of the band, where half is left.
    pub(crate) edge_hz: f64,
}

impl LowPass {
    /// How far it reaches on each side \[s\].
    pub(crate) fn reach_s(&self) -> f64 {
        LOW_PASS_PERIODS / self.edge_hz
    }

    /// Distance of the rows behind it \[s\].
    pub(crate) fn row_s(&self) -> f64 {
        0.5 / self.edge_hz
    }

    /// Weight of a sample, up to a factor, at a distance in time.
    pub(crate) fn weight(&self, distance_s: f64) -> f64 {
        let x = self.edge_hz * distance_s;
        if x.abs() >= LOW_PASS_PERIODS {
            return 0.0;
        }
        let hann = 0.5 + 0.5 * (PI * x / LOW_PASS_PERIODS).cos();
        let angle = 2.0 * PI * x;
        let sinc = match angle.abs() < 1e-9 {
            true => 1.0,
            false => angle.sin() / angle,
        };
        hann * sinc
    }

    /// Weights of samples `step_s` apart that add up to 1, one of them `offset_s` before the row's time; and the position of the
    /// first one relative to that sample.
    pub(crate) fn weights(&self, step_s: f64, offset_s: f64) -> (isize, Vec<f64>) {
        let reach = (self.reach_s() / step_s).ceil() as isize + 1;
        let mut weights: Vec<f64> = (-reach..=reach)
            .map(|k| self.weight(k as f64 * step_s - offset_s))
            .collect();
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= sum);
        (-reach, weights)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_signals_pass_and_fast_ones_do_not() {
        let (pass, step_s) = (LowPass { edge_hz: 20.0 }, 0.005);
        for (hz, low, high) in [
            (2.0, 0.998, 1.001),
            (10.0, 0.97, 1.03),
            (20.0, 0.45, 0.55),
            (35.0, -0.02, 0.02),
        ] {
            for offset_s in [0.0, 0.0017] {
                let (first, weights) = pass.weights(step_s, offset_s);
                let gain: f64 = (weights.iter().enumerate())
                    .map(|(k, weight)| {
                        let t = (first + k as isize) as f64 * step_s - offset_s;
                        weight * (2.0 * PI * hz * t).cos()
                    })
                    .sum();
                assert!((low..high).contains(&gain), "{hz} Hz at {offset_s}: {gain}");
            }
        }
    }

    #[test]
    fn noise_of_neighbouring_rows_is_independent() {
        let (pass, step_s) = (LowPass { edge_hz: 20.0 }, 0.001);
        let (_, weights) = pass.weights(step_s, 0.0);
        let lag = (pass.row_s() / step_s).round() as usize;
        let own: f64 = weights.iter().map(|weight| weight * weight).sum();
        let shared: f64 = weights
            .iter()
            .zip(&weights[lag..])
            .map(|(a, b)| a * b)
            .sum();
        assert!((shared / own).abs() < 0.11, "{}", shared / own);
    }
}
