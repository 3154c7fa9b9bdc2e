//! An integral and a derivative in the loop of Figure 11: rest, a hand that lets go, noise.
//!
//! One axis, along the handle's z, with the dynamics of the loop (docs/assumptions.md, Figures and force).

use std::f64::consts::TAU;

use haptical_model::kinematics::nalgebra::{Matrix6, Vector6};
use xtask_blind::Random;

use super::closed_loop::{
    ACTUATOR_HZ, Axis, DAMPING, FIXTURE_N_PER_M, HANDLE_KG, Law, SAMPLE_S, run,
};
use super::figure12::SENSOR_SD_N;

/// Wall of the paper \[N/m\], and how deep the handle is held in it \[m\].
const WALL_N_PER_M: f64 = 100.0;
/// See [`WALL_N_PER_M`].
pub(crate) const DEPTH_M: f64 = 0.02;
/// The handle is held this long in the wall, then let go \[s\].
pub(crate) const HELD_S: f64 = 0.4;
const END_S: f64 = 0.8;
/// Steps of the integration within a sample.
const SUBSTEPS: usize = 50;

/// One sample of a hand that lets go.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Instant {
    pub(crate) time_s: f64,
    /// What the wall wants, along the way out.
    pub(crate) wanted_n: f64,
    /// What the drives exert on the handle.
    pub(crate) drives_n: f64,
    /// Place of the handle; positive is outside of the wall.
    pub(crate) outside_m: f64,
    pub(crate) speed_mps: f64,
}

/// The wall is switched on around a handle that a fixture holds in it; then the fixture opens. The sensor is
/// between handle and hand, so it shows nothing from then on. `share` of what is wanted comes out of the model.
pub(crate) fn let_go(law: &Law, share: f64) -> Vec<Instant> {
    let samples = (END_S / SAMPLE_S) as usize;
    let step_s = SAMPLE_S / SUBSTEPS as f64;
    let pole = TAU * ACTUATOR_HZ;
    let damper = 2.0 * DAMPING * (FIXTURE_N_PER_M * HANDLE_KG).sqrt();
    let (mut drives_n, mut at_m, mut speed_mps) = (0.0, -DEPTH_M, 0.0);
    let (mut waiting_n, mut integral, mut before_n) = (0.0, 0.0, 0.0);
    let mut course = Vec::with_capacity(samples);
    for sample in 0..samples {
        let time_s = sample as f64 * SAMPLE_S;
        let held = time_s < HELD_S;
        let fixture_n = |at_m: f64| {
            if held {
                FIXTURE_N_PER_M * (at_m + DEPTH_M)
            } else {
                0.0
            }
        };
        let wanted_n = WALL_N_PER_M * (-at_m).max(0.0);
        course.push(Instant {
            time_s,
            wanted_n,
            drives_n,
            outside_m: at_m,
            speed_mps,
        });
        let acting_n = share * waiting_n;
        let error_n = wanted_n - fixture_n(at_m);
        integral += error_n * SAMPLE_S;
        waiting_n = wanted_n
            + law.gain * error_n
            + law.integral_per_s * integral
            + law.derivative_s / SAMPLE_S * (error_n - before_n);
        before_n = error_n;
        for _ in 0..SUBSTEPS {
            let damping_n = if held { damper * speed_mps } else { 0.0 };
            drives_n += step_s * pole * (acting_n - drives_n);
            speed_mps += step_s * (drives_n - fixture_n(at_m) - damping_n) / HANDLE_KG;
            at_m += step_s * speed_mps;
        }
    }
    course
}

/// What is left of a course of [`let_go`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Outcome {
    /// Error of the force when the fixture opens \[N\].
    pub(crate) rest_error_n: f64,
    /// Energy of the handle where it leaves the wall \[J\]; none if it does not.
    pub(crate) energy_j: Option<f64>,
    /// What pushes the free handle at the end \[N\], and its speed \[m/s\].
    pub(crate) last_n: f64,
    pub(crate) last_mps: f64,
}

/// Energy that the wall stores at that depth \[J\].
pub(crate) fn wall_energy_j() -> f64 {
    0.5 * WALL_N_PER_M * DEPTH_M * DEPTH_M
}

pub(crate) fn outcome(course: &[Instant]) -> Option<Outcome> {
    let held = course.iter().rev().find(|at| at.time_s < HELD_S)?;
    let left = course
        .iter()
        .find(|at| at.time_s >= HELD_S && at.outside_m >= 0.0);
    let last = course.last()?;
    Some(Outcome {
        rest_error_n: held.wanted_n - held.drives_n,
        energy_j: left.map(|at| 0.5 * HANDLE_KG * at.speed_mps * at.speed_mps),
        last_n: last.drives_n,
        last_mps: last.speed_mps,
    })
}

/// What the sensor's noise alone makes of a law.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Noise {
    /// RMS of the commanded force \[N\].
    pub(crate) command_n: f64,
    /// RMS of the force in the fixture \[N\].
    pub(crate) handle_n: f64,
}

/// Samples of the noise, six axes each, and those at the beginning that are left out.
const NOISE_SAMPLES: usize = 8_000;
const SETTLING_SAMPLES: usize = 1_000;

/// RMS of what the sensor's noise makes of a law that settles.
pub(crate) fn noise(axis: &Axis, law: &Law, seed: u64) -> Noise {
    let mut random = Random::new(seed, 2);
    let sensor: Vec<Vector6<f64>> = (0..NOISE_SAMPLES)
        .map(|_| Vector6::from_fn(|_, _| SENSOR_SD_N * random.normal()))
        .collect();
    let nothing = vec![Vector6::zeros(); NOISE_SAMPLES];
    let found = run(axis, &Matrix6::identity(), law, &nothing, &sensor);
    let rms_n = |wrenches: &[Vector6<f64>]| {
        let late = &wrenches[SETTLING_SAMPLES..];
        let sum: f64 = late.iter().map(Vector6::norm_squared).sum();
        (sum / (6 * late.len()) as f64).sqrt()
    };
    Noise {
        command_n: rms_n(&found.commanded),
        handle_n: rms_n(&found.measured),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(gain: f64, integral_per_s: f64, derivative_s: f64) -> Law {
        Law {
            gain,
            integral_per_s,
            derivative_s,
        }
    }

    /// While the handle is held this is the loop of the other module, by another integration.
    #[test]
    fn a_held_handle_is_the_sampled_loop() {
        let axis = Axis::new(FIXTURE_N_PER_M, DAMPING);
        for law in [law(0.3, 0.0, 0.0), law(0.3, 20.0, 0.0), law(0.3, 0.0, 5e-4)] {
            let course = let_go(&law, 0.93);
            let samples = (HELD_S / SAMPLE_S) as usize;
            let wanted: Vec<Vector6<f64>> = course[..samples]
                .iter()
                .map(|at| Vector6::new(0.0, 0.0, at.wanted_n, 0.0, 0.0, 0.0))
                .collect();
            let quiet = vec![Vector6::zeros(); samples];
            let transmission = Matrix6::identity() * 0.93;
            let sampled = run(&axis, &transmission, &law, &wanted, &quiet).measured;
            for (at, sampled) in course.iter().zip(&sampled) {
                let force = FIXTURE_N_PER_M * (at.outside_m + DEPTH_M);
                // 20 us of Euler steps against an exact exponential
                assert!((force - sampled[2]).abs() < 0.02, "{at:?} {}", sampled[2]);
            }
        }
    }

    /// A free handle leaves a proportional wall with (1 + G) share of its energy, but for the delay and the
    /// actuator's pole, and nothing pushes it outside; an integral goes on pushing.
    #[test]
    fn an_integral_goes_on_pushing_a_free_handle() {
        for (gain, share) in [(0.0, 1.0), (0.4, 1.0), (0.4, 0.9)] {
            let found = outcome(&let_go(&law(gain, 0.0, 0.0), share)).unwrap();
            let energy = found.energy_j.unwrap() / wall_energy_j();
            let expected = share * (1.0 + gain);
            assert!(
                (energy / expected - 1.0).abs() < 0.15,
                "{energy} {expected}"
            );
            assert!(found.last_n.abs() < 1e-9, "{found:?}");
        }
        let found = outcome(&let_go(&law(0.4, 10.0, 0.0), 0.9)).unwrap();
        assert!(
            found.rest_error_n.abs() < 0.05 && found.last_n > 0.5,
            "{found:?}"
        );
    }

    /// White noise of standard deviation s through u = -G n - k_d (n - n') / T without a device behind it has
    /// the variance s^2 ((G + k)^2 + k^2), k = k_d / T.
    #[test]
    fn a_difference_amplifies_white_noise() {
        // so soft a fixture that nothing comes back
        let axis = Axis::new(1e-3, 1.0);
        for (gain, derivative_s) in [(0.4, 0.0), (0.4, 1e-3), (0.0, 3e-3)] {
            let found = noise(&axis, &law(gain, 0.0, derivative_s), 5).command_n;
            let k = derivative_s / SAMPLE_S;
            let expected = SENSOR_SD_N * ((gain + k).powi(2) + k * k).sqrt();
            // 42 000 numbers: 0.4 %
            assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
        }
    }
}
