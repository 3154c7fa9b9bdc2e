//! A position controller, as a robot's drives have one: stiffness and damping towards a command, and gravity of a model.

use std::f64::consts::TAU;

use haptical_model::{ModelError, MotionWork, RigidBodies};

/// A controller of all joints at one rate:
///
/// ```text
/// tau = kp (command - theta) + kd (d command/dt - d theta/dt) + g(theta)
/// ```
///
/// d theta/dt behind a low-pass of the first order, g the torques that hold a model's links at theta. What it exerts stays
/// until its next tick.
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    /// Stiffness of each joint \[N m/rad\], \[N/m\].
    pub kp: Vec<f64>,
    /// Damping of each joint \[N m s/rad\], \[N s/m\].
    pub kd: Vec<f64>,
    /// The model whose gravity it adds; none where it adds none.
    pub gravity: Option<RigidBodies>,
    /// Ticks a second \[Hz\].
    pub rate_hz: f64,
    /// Corner of the low-pass behind which it sees velocities \[Hz\]; none for the velocities themselves.
    pub velocity_lowpass_hz: Option<f64>,
    /// Most that each drive gives \[N m\], \[N\], where known.
    pub limits: Vec<Option<f64>>,
}

/// What a controller is told at a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command<'c> {
    /// Positions \[rad\], \[m\].
    pub theta: &'c [f64],
    /// Velocities per second.
    pub dtheta: &'c [f64],
}

/// What a controller keeps from tick to tick.
#[derive(Debug, Clone)]
pub struct ControllerState {
    /// Velocities behind the low-pass.
    seen: Vec<f64>,
    work: Option<MotionWork>,
}

impl Controller {
    /// At the first tick, in which the low-pass shows these velocities.
    pub fn start(&self, dtheta: &[f64]) -> ControllerState {
        ControllerState {
            seen: dtheta.to_vec(),
            work: self.gravity.as_ref().map(RigidBodies::work),
        }
    }

    /// Torques of one tick, at the joints' positions and velocities.
    ///
    /// ```
    /// use haptical_simulator::{Command, Controller};
    /// let controller = Controller {
    ///     kp: vec![100.0],
    ///     kd: vec![5.0],
    ///     gravity: None,
    ///     rate_hz: 1000.0,
    ///     velocity_lowpass_hz: None,
    ///     limits: vec![Some(20.0)],
    /// };
    /// let mut state = controller.start(&[0.0]);
    /// let command = Command { theta: &[0.1], dtheta: &[0.5] };
    /// let mut torque_nm = [0.0];
    /// controller.tick(&mut state, command, (&[0.0], &[0.3]), &mut torque_nm)?;
    /// assert!((torque_nm[0] - 11.0).abs() < 1e-12);
    /// # Ok::<(), haptical_simulator::model::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// As [`RigidBodies::bias`].
    pub fn tick(
        &self,
        state: &mut ControllerState,
        command: Command<'_>,
        (theta, dtheta): (&[f64], &[f64]),
        torques: &mut [f64],
    ) -> Result<(), ModelError> {
        torques.fill(0.0);
        if let (Some(bodies), Some(work)) = (&self.gravity, &mut state.work) {
            let rest = vec![0.0; theta.len()];
            bodies.bias(theta, &rest, work, torques)?;
        }
        let passed = self
            .velocity_lowpass_hz
            .map_or(1.0, |corner| 1.0 - libm::exp(-TAU * corner / self.rate_hz));
        for (joint, torque) in torques.iter_mut().enumerate() {
            let seen = &mut state.seen[joint];
            *seen += passed * (dtheta[joint] - *seen);
            *torque += self.kp[joint] * (command.theta[joint] - theta[joint])
                + self.kd[joint] * (command.dtheta[joint] - *seen);
            if let Some(limit) = self.limits[joint] {
                *torque = torque.clamp(-limit, limit);
            }
        }
        Ok(())
    }
}
