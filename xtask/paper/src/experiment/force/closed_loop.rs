//! The loop of Figure 11 in time: 1 kHz, one sample of delay, the actuators' pole, the clamped handle's mode.
//!
//! Every axis of the wrench has the same dynamics; the model's error mixes the axes at rest
//! (docs/assumptions.md, Figures and force).

use std::f64::consts::TAU;

use haptical_model::kinematics::nalgebra::{Matrix3, Matrix4, Matrix6, Vector3, Vector6};

/// Sampling of the paper's controller \[s\].
pub(crate) const SAMPLE_S: f64 = 1e-3;
/// Pole of the actuators and their current loops \[Hz\].
pub(crate) const ACTUATOR_HZ: f64 = 200.0;
/// Stiffness of the fixture that clamps the handle \[N/m\].
pub(crate) const FIXTURE_N_PER_M: f64 = 20e3;
/// Mass of handle and links that the fixture feels \[kg\], and the damping of that mode.
pub(crate) const HANDLE_KG: f64 = 0.3;
/// See [`HANDLE_KG`].
pub(crate) const DAMPING: f64 = 0.2;

/// tau = Jhat^T [F_d + G e + k_i int e dt + k_d de/dt] with e = F_d - F.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Law {
    pub(crate) gain: f64,
    /// k_i \[1/s\]: rectangles of one sample.
    pub(crate) integral_per_s: f64,
    /// k_d \[s\]: the difference of two samples.
    pub(crate) derivative_s: f64,
}

impl Law {
    /// The paper's.
    pub(crate) fn proportional(gain: f64) -> Self {
        Self {
            gain,
            integral_per_s: 0.0,
            derivative_s: 0.0,
        }
    }

    pub(crate) fn with_integral(self, integral_per_s: f64) -> Self {
        Self {
            integral_per_s,
            ..self
        }
    }

    pub(crate) fn with_derivative(self, derivative_s: f64) -> Self {
        Self {
            derivative_s,
            ..self
        }
    }
}

/// Dynamics of one axis between commanded and measured force, for a command held over a sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Axis {
    /// States: actuator force, force in the fixture, its rate.
    step: Matrix3<f64>,
    input: Vector3<f64>,
}

impl Axis {
    /// Exact discretisation (Franklin, Powell & Workman, Digital Control of Dynamic Systems, section 4.3).
    pub(crate) fn new(fixture_n_per_m: f64, damping: f64) -> Self {
        let pole = TAU * ACTUATOR_HZ;
        let mode = (fixture_n_per_m / HANDLE_KG).sqrt();
        // [A b; 0 0]: its exponential holds both matrices of the sampled system
        let rows = [
            [-pole, 0.0, 0.0, pole],
            [0.0, 0.0, 1.0, 0.0],
            [mode * mode, -mode * mode, -2.0 * damping * mode, 0.0],
            [0.0; 4],
        ];
        let continuous = Matrix4::from_row_slice(rows.as_flattened());
        let sampled = (continuous * SAMPLE_S).exp();
        Self {
            step: sampled.fixed_view::<3, 3>(0, 0).into_owned(),
            input: sampled.fixed_view::<3, 1>(0, 3).into_owned(),
        }
    }

    /// The loop of one axis whose force comes out exactly, sample to sample: the axis's three states, the
    /// command that waits one sample, the error before, the integral.
    pub(crate) fn closed(&self, law: &Law) -> Matrix6<f64> {
        let mut all = Matrix6::zeros();
        all.fixed_view_mut::<3, 3>(0, 0).copy_from(&self.step);
        all.fixed_view_mut::<3, 1>(0, 3).copy_from(&self.input);
        // nothing is wanted: the error is minus the force that is measured now
        let difference = law.derivative_s / SAMPLE_S;
        all[(3, 1)] = -(law.gain + law.integral_per_s * SAMPLE_S + difference);
        all[(3, 4)] = -difference;
        all[(3, 5)] = law.integral_per_s;
        all[(4, 1)] = -1.0;
        if law.integral_per_s != 0.0 {
            all[(5, 5)] = 1.0;
            all[(5, 1)] = -SAMPLE_S;
        }
        all
    }

    /// Largest magnitude of an eigenvalue of the loop: below 1 it settles.
    pub(crate) fn spectral_radius(&self, law: &Law) -> f64 {
        let values = self.closed(law).complex_eigenvalues();
        values.iter().map(|value| value.norm()).fold(0.0, f64::max)
    }

    /// Where the loop stops settling: the largest number up to `high` for whose law it does, for laws that
    /// settle below it and not above.
    pub(crate) fn largest(&self, high: f64, law: impl Fn(f64) -> Law) -> f64 {
        let (mut low, mut high) = (0.0, high);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.spectral_radius(&law(middle)) < 1.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }

    /// Largest gain of the proportional law.
    pub(crate) fn largest_gain(&self) -> f64 {
        self.largest(100.0, Law::proportional)
    }
}

/// Wrenches of a run, sample by sample.
#[derive(Debug)]
pub(crate) struct Wrenches {
    /// What the sensor would show without noise.
    pub(crate) measured: Vec<Vector6<f64>>,
    pub(crate) commanded: Vec<Vector6<f64>>,
}

/// Runs the loop: wanted wrenches sample by sample, the model's matrix M, the sensor's noise.
pub(crate) fn run(
    axis: &Axis,
    transmission: &Matrix6<f64>,
    law: &Law,
    wanted: &[Vector6<f64>],
    noise: &[Vector6<f64>],
) -> Wrenches {
    // force of the actuators, force in the fixture, its rate
    let mut state = [Vector6::zeros(); 3];
    let mut waiting = Vector6::zeros();
    let mut integral: Vector6<f64> = Vector6::zeros();
    let mut before: Vector6<f64> = Vector6::zeros();
    let mut found = Wrenches {
        measured: Vec::with_capacity(wanted.len()),
        commanded: Vec::with_capacity(wanted.len()),
    };
    for (wanted, noise) in wanted.iter().zip(noise) {
        let felt: Vector6<f64> = state[1];
        found.measured.push(felt);
        // what was commanded one sample ago acts now, through the true device
        let acting = transmission * waiting;
        let error = wanted - felt - noise;
        integral += error * SAMPLE_S;
        waiting = wanted
            + error * law.gain
            + integral * law.integral_per_s
            + (error - before) * (law.derivative_s / SAMPLE_S);
        before = error;
        found.commanded.push(waiting);
        let (s, b, [a, f, r]) = (&axis.step, &axis.input, state);
        state = [0, 1, 2].map(|k| a * s[(k, 0)] + f * s[(k, 1)] + r * s[(k, 2)] + acting * b[k]);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assumed() -> Axis {
        Axis::new(FIXTURE_N_PER_M, DAMPING)
    }

    fn pushed(samples: usize) -> (Vec<Vector6<f64>>, Vec<Vector6<f64>>) {
        let wanted = vec![Vector6::new(0.0, 0.0, 2.0, 0.0, 0.0, 0.0); samples];
        (wanted, vec![Vector6::zeros(); samples])
    }

    #[test]
    fn the_loop_settles_where_the_statics_say() {
        let axis = assumed();
        let mut transmission = Matrix6::identity();
        transmission[(0, 2)] = 0.1;
        transmission[(2, 2)] = 0.9;
        let (wanted, quiet) = pushed(4000);
        for gain in [0.0, 0.5 * axis.largest_gain()] {
            let law = Law::proportional(gain);
            let last = run(&axis, &transmission, &law, &wanted, &quiet).measured[3999];
            // (1 + G M)^-1 (1 + G) M W
            let rest = (Matrix6::identity() + transmission * gain)
                .lu()
                .solve(&(transmission * wanted[0] * (1.0 + gain)))
                .unwrap();
            assert!((last - rest).norm() < 1e-9, "{gain}: {last} {rest}");
            // an integral leaves no error in any axis, a derivative changes nothing at rest
            let with = |integral_per_s, derivative_s| Law {
                gain,
                integral_per_s,
                derivative_s,
            };
            let at_rest =
                |law: &Law| run(&axis, &transmission, law, &wanted, &quiet).measured[3999];
            assert!((at_rest(&with(20.0, 0.0)) - wanted[0]).norm() < 1e-9);
            assert!((at_rest(&with(0.0, 5e-4)) - rest).norm() < 1e-9);
        }
    }

    /// The eigenvalues' limit is that of the loop in time, for every fixture and every law.
    #[test]
    fn beyond_the_limit_the_force_grows() {
        let (wanted, quiet) = pushed(30_000);
        let late = |axis: &Axis, law: &Law| {
            let forces = run(axis, &Matrix6::identity(), law, &wanted, &quiet).measured;
            (forces[29_999] - wanted[0]).norm()
        };
        let check = |axis: &Axis, high: f64, law: &dyn Fn(f64) -> Law| {
            let limit = axis.largest(high, law);
            assert!(limit > 0.0 && limit < 0.99 * high, "{limit}");
            let (below, above) = (
                late(axis, &law(0.97 * limit)),
                late(axis, &law(1.03 * limit)),
            );
            assert!(below < 1e-3 && above > 10.0, "{limit}: {below} {above}");
        };
        for stiffness in [5e3, FIXTURE_N_PER_M, 80e3] {
            check(&Axis::new(stiffness, DAMPING), 100.0, &Law::proportional);
        }
        let gain = 0.5 * assumed().largest_gain();
        check(&assumed(), 1e4, &|k_i| {
            Law::proportional(gain).with_integral(k_i)
        });
        check(&assumed(), 1.0, &|k_d| {
            Law::proportional(gain).with_derivative(k_d)
        });
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
