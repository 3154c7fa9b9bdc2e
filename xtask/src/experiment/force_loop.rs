//! The loop of Figure 11 in time: 1 kHz, one sample of delay, the actuators' pole, the clamped handle's mode.
//!
//! Every axis of the wrench has the same dynamics; the model's error mixes the axes at rest
//! (docs/assumptions.md, Figures and force).

use std::f64::consts::TAU;

use haptical_model::kinematics::nalgebra::{Matrix3, Matrix4, Matrix6, SMatrix, Vector3, Vector6};

/// Sampling of the paper's controller \[s\].
pub(crate) const SAMPLE_S: f64 = 1e-3;
/// Pole of the actuators and their current loops \[Hz\].
const ACTUATOR_HZ: f64 = 200.0;
/// Stiffness of the fixture that clamps the handle \[N/m\].
const FIXTURE_N_PER_M: f64 = 20e3;
/// Mass of handle and links that the fixture feels \[kg\], and the damping of that mode.
const HANDLE_KG: f64 = 0.3;
/// See [`HANDLE_KG`].
pub(crate) const DAMPING: f64 = 0.2;

/// Dynamics of one axis between commanded and measured force, for a command held over a sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Axis {
    /// States: actuator force, force in the fixture, its rate.
    step: Matrix3<f64>,
    input: Vector3<f64>,
}

impl Axis {
    /// Exact discretisation (Franklin, Powell & Workman, Digital Control of Dynamic Systems, section 4.3).
    pub(crate) fn new(damping: f64) -> Self {
        let pole = TAU * ACTUATOR_HZ;
        let mode = (FIXTURE_N_PER_M / HANDLE_KG).sqrt();
        // [A b; 0 0]: its exponential holds both matrices of the sampled system
        let continuous = Matrix4::new(
            -pole,
            0.0,
            0.0,
            pole, //
            0.0,
            0.0,
            1.0,
            0.0, //
            mode * mode,
            -mode * mode,
            -2.0 * damping * mode,
            0.0, //
            0.0,
            0.0,
            0.0,
            0.0,
        );
        let sampled = (continuous * SAMPLE_S).exp();
        Self {
            step: sampled.fixed_view::<3, 3>(0, 0).into_owned(),
            input: sampled.fixed_view::<3, 1>(0, 3).into_owned(),
        }
    }

    /// Largest magnitude of an eigenvalue of the loop with a gain: below 1 it settles. The states are the
    /// axis's and the command that waits one sample.
    pub(crate) fn spectral_radius(&self, gain: f64) -> f64 {
        let mut all = SMatrix::<f64, 4, 4>::zeros();
        all.fixed_view_mut::<3, 3>(0, 0).copy_from(&self.step);
        all.fixed_view_mut::<3, 1>(0, 3).copy_from(&self.input);
        // the next waiting command: -G times the force that is measured now
        all[(3, 1)] = -gain;
        all.complex_eigenvalues()
            .iter()
            .map(|value| value.norm())
            .fold(0.0, f64::max)
    }

    /// Gain at which the loop stops settling.
    pub(crate) fn largest_gain(&self) -> f64 {
        let (mut low, mut high) = (0.0, 100.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.spectral_radius(middle) < 1.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }
}

/// Runs the loop: wanted wrenches sample by sample, the model's matrix M, the sensor's noise; returns what the
/// sensor would show without noise.
pub(crate) fn run(
    axis: &Axis,
    transmission: &Matrix6<f64>,
    gain: f64,
    wanted: &[Vector6<f64>],
    noise: &[Vector6<f64>],
) -> Vec<Vector6<f64>> {
    let mut actuator = Vector6::zeros();
    let mut fixture = Vector6::zeros();
    let mut rate = Vector6::zeros();
    let mut waiting = Vector6::zeros();
    let mut measured = Vec::with_capacity(wanted.len());
    for (wanted, noise) in wanted.iter().zip(noise) {
        let felt: Vector6<f64> = fixture;
        measured.push(felt);
        // what was commanded one sample ago acts now, through the true device
        let acting = transmission * waiting;
        waiting = wanted + (wanted - felt - noise) * gain;
        let (a, f, r) = (actuator, fixture, rate);
        let (s, b) = (&axis.step, &axis.input);
        actuator = a * s[(0, 0)] + f * s[(0, 1)] + r * s[(0, 2)] + acting * b[0];
        fixture = a * s[(1, 0)] + f * s[(1, 1)] + r * s[(1, 2)] + acting * b[1];
        rate = a * s[(2, 0)] + f * s[(2, 1)] + r * s[(2, 2)] + acting * b[2];
    }
    measured
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_loop_settles_where_the_statics_say() {
        let axis = Axis::new(DAMPING);
        let mut transmission = Matrix6::identity();
        transmission[(0, 2)] = 0.1;
        transmission[(2, 2)] = 0.9;
        let wanted = vec![Vector6::new(0.0, 0.0, 2.0, 0.0, 0.0, 0.0); 4000];
        let quiet = vec![Vector6::zeros(); 4000];
        for gain in [0.0, 0.5 * axis.largest_gain()] {
            let last = run(&axis, &transmission, gain, &wanted, &quiet)[3999];
            // (1 + G M)^-1 (1 + G) M W
            let rest = (Matrix6::identity() + transmission * gain)
                .lu()
                .solve(&(transmission * wanted[0] * (1.0 + gain)))
                .unwrap();
            assert!((last - rest).norm() < 1e-9, "{gain}: {last} {rest}");
        }
    }

    #[test]
    fn beyond_the_largest_gain_the_force_grows() {
        let axis = Axis::new(DAMPING);
        let limit = axis.largest_gain();
        assert!(limit > 0.0 && limit < 100.0, "{limit}");
        let wanted = vec![Vector6::new(0.0, 0.0, 2.0, 0.0, 0.0, 0.0); 20_000];
        let quiet = vec![Vector6::zeros(); wanted.len()];
        let late = |gain: f64| {
            let forces = run(&axis, &Matrix6::identity(), gain, &wanted, &quiet);
            (forces[19_999] - wanted[0]).norm()
        };
        assert!(late(0.97 * limit) < 1e-3 && late(1.03 * limit) > 10.0);
    }

    /// Without the fixture's mode the limit has a closed form: z^2 - a z + (1 - a) G has a root on the circle at
    /// (1 - a) G = 1, a = exp(-2 pi 200 / 1000).
    #[test]
    fn a_stiff_light_handle_has_the_closed_form() {
        let a = (-TAU * ACTUATOR_HZ * SAMPLE_S).exp();
        let axis = Axis {
            step: Matrix3::new(a, 0.0, 0.0, a, 0.0, 0.0, 0.0, 0.0, 0.0),
            input: Vector3::new(1.0 - a, 1.0 - a, 0.0),
        };
        assert!((axis.largest_gain() - 1.0 / (1.0 - a)).abs() < 1e-6);
    }
}
