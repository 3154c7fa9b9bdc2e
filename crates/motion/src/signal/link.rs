//! Positions of the links by encoders on them.
//!
//! An encoder on a link may be noisier than the one on its motor, and the accelerations of bodies carry its noise into the torques. The
//! difference between the two is the drive's deflection and error, which is often slower than the motion: the difference is smoothed
//! as far as that changes it by no more than noise, and added to the motor's position (docs/equations.md, "Encoders on links").

use haptical_linalg::dot;

use crate::signal::local_polynomial::LocalPolynomial;
use crate::signal::noise::Noise;
use crate::signal::samples::Samples;
use crate::thresholds::signal::{DIFFERENCE_HALVINGS, DIFFERENCE_SDS};

/// Positions of one joint's link.
#[derive(Debug, Clone)]
pub(crate) struct Link {
    /// Samples of each piece \[rad\] or \[m\].
    pub(crate) pieces: Vec<Vec<f64>>,
    /// Standard deviation of the noise of a reading that is smoothed: the link's, or that of its difference from the motor's.
    pub(crate) sd: f64,
    /// What smooths the difference from the motor; none where the link's readings are taken as they are.
    pub(crate) smoother: Option<LocalPolynomial>,
}

impl Link {
    /// Of a joint, for positions that are smoothed up to a cutoff afterwards; none without an encoder on the link.
    pub(crate) fn new(samples: &Samples, joint: usize, cutoff_hz: f64) -> Option<Self> {
        let local = LocalPolynomial::new(samples.step_s, cutoff_hz);
        let links = samples.pieces.iter().map(|piece| piece.link[joint].clone());
        let links = links.collect::<Option<Vec<Vec<f64>>>>()?;
        let motors: Vec<&[f64]> = (samples.pieces.iter())
            .map(|piece| piece.motor[joint].as_slice())
            .collect();
        let differences: Vec<Vec<f64>> = (links.iter().zip(&motors))
            .map(|(link, motor)| link.iter().zip(*motor).map(|(a, b)| a - b).collect())
            .collect();
        let noise = |columns: &[&[f64]]| Noise::white(columns.iter().copied(), &local).sd;
        let [of_link, of_difference] = [&links, &differences].map(|columns| {
            let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
            noise(&columns)
        });
        let smoother = match of_link > noise(&motors) {
            true => widest(samples.step_s, cutoff_hz, &differences, of_difference),
            false => None,
        };
        let Some(smoother) = smoother else {
            return Some(Self {
                pieces: links,
                sd: of_link,
                smoother: None,
            });
        };
        let added = |(motor, difference): (&&[f64], &Vec<f64>)| {
            let smoothed = |k: usize| match difference.len() > 2 * smoother.half {
                true => smoother.smoothed(difference, k),
                false => difference[k],
            };
            (motor.iter().enumerate())
                .map(|(k, motor)| motor + smoothed(k))
                .collect()
        };
        Some(Self {
            pieces: motors.iter().zip(&differences).map(added).collect(),
            sd: of_difference,
            smoother: Some(smoother),
        })
    }
}

/// The widest window that changes the differences by no more than their noise does, against the window of the cutoff.
fn widest(
    step_s: f64,
    cutoff_hz: f64,
    differences: &[Vec<f64>],
    noise_sd: f64,
) -> Option<LocalPolynomial> {
    let local = LocalPolynomial::new(step_s, cutoff_hz);
    let long: Vec<&[f64]> = (differences.iter().map(Vec::as_slice))
        .filter(|piece| piece.len() > 2 * local.half)
        .collect();
    let shortest = long.iter().map(|piece| piece.len()).min()?;
    let is_noise = |window: &LocalPolynomial| {
        let mut weights = window.weights[0].clone();
        let inner = &mut weights[window.half - local.half..];
        (inner.iter_mut().zip(&local.weights[0])).for_each(|(wide, narrow)| *wide -= narrow);
        let squares: Vec<f64> = (long.iter())
            .flat_map(|piece| piece.windows(weights.len()))
            .map(|readings| dot(readings, &weights).powi(2))
            .collect();
        // values that are independent of each other: one in half a window
        let independent = squares.len() as f64 / local.half as f64;
        let chance = 1.0 + DIFFERENCE_SDS * (2.0 / independent).sqrt();
        let mean_square = squares.iter().sum::<f64>() / squares.len() as f64;
        mean_square <= chance * noise_sd.powi(2) * dot(&weights, &weights)
    };
    (1..=DIFFERENCE_HALVINGS)
        .map(|halvings| LocalPolynomial::new(step_s, cutoff_hz * 0.5_f64.powi(halvings)))
        .take_while(|window| 2 * window.half < shortest)
        .take_while(is_noise)
        .last()
}

#[cfg(test)]
mod tests {
    use haptical_model::Recording;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    const STEP_S: f64 = 0.005;
    const CUTOFF_HZ: f64 = 40.0;

    /// A joint that swings at 1 Hz; its link lags behind the motor by a wave, and both are read with noise.
    fn samples(wave_rad: f64, wave_hz: f64, [motor_sd, link_sd]: [f64; 2]) -> Samples {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mut noise = |sd: f64| {
            let normal: f64 = StandardNormal.sample(&mut random);
            sd * normal
        };
        let time_s: Vec<f64> = (0..3000).map(|k| STEP_S * f64::from(k)).collect();
        let wave = |hz: f64, t: f64| (core::f64::consts::TAU * hz * t).sin();
        let motor: Vec<f64> = time_s.iter().map(|t| wave(1.0, *t)).collect();
        let link = (motor.iter().zip(&time_s))
            .map(|(motor, t)| motor - 0.01 - wave_rad * wave(wave_hz, *t) + noise(link_sd))
            .collect();
        let log = Recording {
            line: (2..).take(time_s.len()).collect(),
            output: vec![Some(link)],
            joint: vec![motor.iter().map(|motor| motor + noise(motor_sd)).collect()],
            torque_nm: vec![Some(time_s.iter().map(|t| t.cos()).collect())],
            time_s: Some(time_s),
            ..Recording::default()
        };
        Samples::new(&log, false).unwrap()
    }

    fn off_rad(link: &Link, wave_rad: f64, wave_hz: f64) -> f64 {
        let truth = |k: usize| {
            let wave = |hz: f64| (core::f64::consts::TAU * hz * STEP_S * k as f64).sin();
            wave(1.0) - 0.01 - wave_rad * wave(wave_hz)
        };
        let positions = link.pieces[0].iter().enumerate();
        let squares: f64 = positions.map(|(k, rad)| (rad - truth(k)).powi(2)).sum();
        (squares / link.pieces[0].len() as f64).sqrt()
    }

    #[test]
    fn a_noisy_encoder_on_a_stiff_drive_adds_hardly_any_noise() {
        let link = Link::new(&samples(0.0, 1.0, [1e-6, 1e-4]), 0, CUTOFF_HZ).unwrap();
        let off = off_rad(&link, 0.0, 1.0);
        assert!(link.smoother.is_some() && off < 3.5e-5, "{off}");
    }

    #[test]
    fn what_a_drive_yields_is_kept() {
        // at the motion's frequency, and near the band's edge where a smoothed difference would lose it
        for hz in [1.0, 30.0] {
            let link = Link::new(&samples(1e-3, hz, [1e-6, 1e-4]), 0, CUTOFF_HZ).unwrap();
            let off = off_rad(&link, 1e-3, hz);
            assert!(off < 1.1e-4, "{hz} Hz: {off}");
        }
        let link = Link::new(&samples(1e-3, 30.0, [1e-6, 1e-4]), 0, CUTOFF_HZ).unwrap();
        assert!(link.smoother.is_none());
    }

    #[test]
    fn an_encoder_quieter_than_the_motors_is_taken_as_it_reads() {
        let samples = samples(0.0, 1.0, [1e-4, 1e-6]);
        let link = Link::new(&samples, 0, CUTOFF_HZ).unwrap();
        assert!(link.smoother.is_none());
        assert_eq!(&link.pieces[0], samples.pieces[0].link[0].as_ref().unwrap());
    }
}
