//! One step of the equations of motion: a Rosenbrock method of the second order that friction does not make unstable.

use haptical_model::cholesky::{factor, solve};
use haptical_model::{ModelError, MotionWork, RigidBodies};

use super::joint::{JointForces, Resisted, Settled};

/// 1 - 1/sqrt(2): with it the method is L-stable.
const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// Where joints are and how fast.
#[derive(Debug, Clone, PartialEq)]
pub struct ForwardState {
    /// Positions \[rad\], \[m\].
    pub theta: Vec<f64>,
    /// Velocities per second.
    pub dtheta: Vec<f64>,
    pub(super) settled: Vec<Settled>,
}

/// Room for the numbers of a step; used again.
#[derive(Debug, Clone)]
pub struct ForwardWork {
    motion: MotionWork,
    /// Joints by joints: the mass matrix, and the matrix of a stage, then its factor.
    mass: Vec<f64>,
    stage: Vec<f64>,
    bias: Vec<f64>,
    resisted: Vec<Resisted>,
    /// Torques of the drives at the ends of a step.
    pub(super) ends: [Vec<f64>; 2],
    theta: Vec<f64>,
    dtheta: Vec<f64>,
    /// Slopes of the two stages: of positions, of velocities.
    first: [Vec<f64>; 2],
    second: [Vec<f64>; 2],
}

impl ForwardWork {
    pub(super) fn new(bodies: &RigidBodies) -> Self {
        let count = bodies.joint_count();
        let vector = || vec![0.0; count];
        let matrix = || vec![0.0; count * count];
        Self {
            motion: bodies.work(),
            mass: matrix(),
            stage: matrix(),
            bias: vector(),
            resisted: vec![Resisted::default(); count],
            ends: [vector(), vector()],
            theta: vector(),
            dtheta: vector(),
            first: [vector(), vector()],
            second: [vector(), vector()],
        }
    }

    /// Moves a state on by `step_s`, under torques of the drives at its start and at its end.
    ///
    /// With u = (theta, dtheta), `W = 1 - gamma h J`: `W k1 = f(u)`, `W k2 = f(u + h k1) - 2 k1`,
    /// `u + h (3 k1 + k2) / 2`: Verwer, Spee, Blom & Hundsdorfer 1999. It is of the second order whatever J is; here J has
    /// the slopes of friction, cogging left out where it pushes on, and the inverse mass matrix before them, nothing of the
    /// links' own forces. Eliminating the positions leaves one symmetric system in the joints for each stage, the two with one
    /// matrix `M - gamma h D_v - (gamma h)^2 D_q`.
    pub(super) fn step(
        &mut self,
        bodies: &RigidBodies,
        joints: &[JointForces],
        state: &mut ForwardState,
        step_s: f64,
        [start, end]: [&[f64]; 2],
    ) -> Result<(), ModelError> {
        let count = bodies.joint_count();
        let own_h = GAMMA * step_s;
        bodies.mass_matrix(&state.theta, &mut self.motion, &mut self.mass)?;
        bodies.bias(
            &state.theta,
            &state.dtheta,
            &mut self.motion,
            &mut self.bias,
        )?;
        self.stage.copy_from_slice(&self.mass);
        for joint in 0..count {
            let (theta, rate) = (state.theta[joint], state.dtheta[joint]);
            let found = joints[joint].at(&state.settled[joint], theta, rate);
            let slopes = [found.by_theta.max(0.0), found.by_rate.max(0.0)];
            self.resisted[joint] = Resisted {
                torque: found.torque,
                by_theta: slopes[0],
                by_rate: slopes[1],
            };
            self.stage[joint * count + joint] += own_h * (slopes[1] + own_h * slopes[0]);
            self.first[1][joint] =
                start[joint] - self.bias[joint] - found.torque - own_h * slopes[0] * rate;
        }
        factor(&mut self.stage, count)?;
        solve(&self.stage, &mut self.first[1]);
        for joint in 0..count {
            self.first[0][joint] = state.dtheta[joint] + own_h * self.first[1][joint];
            self.theta[joint] = state.theta[joint] + step_s * self.first[0][joint];
            self.dtheta[joint] = state.dtheta[joint] + step_s * self.first[1][joint];
        }
        // accelerations at the end of the first stage, then M (a - 2 k1)
        for joint in 0..count {
            let place = (self.theta[joint], self.dtheta[joint]);
            let found = joints[joint].at(&state.settled[joint], place.0, place.1);
            self.second[1][joint] = end[joint] - found.torque;
        }
        bodies.forward(
            &self.theta,
            &self.dtheta,
            &self.second[1],
            &mut self.motion,
            &mut self.bias,
        )?;
        for joint in 0..count {
            let row = &self.mass[joint * count..][..count];
            let ahead = self.bias.iter().zip(&self.first[1]);
            let pushed = row
                .iter()
                .zip(ahead)
                .map(|(mass, (a, k))| mass * (a - 2.0 * k));
            let rest = self.dtheta[joint] - 2.0 * self.first[0][joint];
            let by_theta = self.resisted[joint].by_theta;
            self.second[1][joint] = pushed.sum::<f64>() - own_h * by_theta * rest;
        }
        solve(&self.stage, &mut self.second[1]);
        for joint in 0..count {
            let rest = self.dtheta[joint] - 2.0 * self.first[0][joint];
            self.second[0][joint] = rest + own_h * self.second[1][joint];
            let along =
                |which: usize| 1.5 * self.first[which][joint] + 0.5 * self.second[which][joint];
            state.theta[joint] += step_s * along(0);
            state.dtheta[joint] += step_s * along(1);
            joints[joint].settle(&mut state.settled[joint], state.theta[joint]);
        }
        Ok(())
    }
}
