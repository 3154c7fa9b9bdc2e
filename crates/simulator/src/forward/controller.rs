//! A position controller, as a robot's drives have one: stiffness and damping towards a command, and gravity of a model.

use std::f64::consts::TAU;

use haptical_model::{Device, ModelError, MotionWork, RigidBodies};
use serde::Deserialize;

use crate::EffectError;

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

/// A controller as a file has it:
///
/// ```toml
/// kp_nm_per_rad = [4500.0, 5000.0]      # N/m where a joint slides
/// kd_nm_s_per_rad = [230.0, 250.0]
/// gravity_compensation = true           # of the nominal model
/// rate_hz = 1000.0
/// velocity_lowpass_hz = 60.0            # optional
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControllerFile {
    /// Stiffness of each joint.
    pub kp_nm_per_rad: Vec<f64>,
    /// Damping of each joint.
    pub kd_nm_s_per_rad: Vec<f64>,
    /// Whether it adds the torques that hold the nominal model's links.
    pub gravity_compensation: bool,
    /// Ticks a second.
    pub rate_hz: f64,
    /// Corner of the low-pass of its velocities.
    pub velocity_lowpass_hz: Option<f64>,
}

impl ControllerFile {
    /// Reads it for a device with this many joints; `file` names it in errors.
    ///
    /// # Errors
    /// [`EffectError`] for what is no such file, and for numbers that no controller has.
    pub fn from_toml(text: &str, file: &str, joints: usize) -> Result<Self, EffectError> {
        let own: Self = toml::from_str(text).map_err(|error| {
            let line = error.span().map(|span| {
                let before = text.get(..span.start).unwrap_or_default();
                before.matches('\n').count() + 1
            });
            let place = line.map_or(file.to_owned(), |line| format!("{file}:{line}"));
            EffectError::new(place, error.message())
        })?;
        let refuse = |what: String| Err(EffectError::new(file, what));
        for (key, gains) in [
            ("kp_nm_per_rad", &own.kp_nm_per_rad),
            ("kd_nm_s_per_rad", &own.kd_nm_s_per_rad),
        ] {
            if gains.len() != joints {
                return refuse(format!(
                    "`{key}` has {} numbers, and the device {joints} joints",
                    gains.len()
                ));
            }
            let is_gain = |gain: &&f64| !(0.0..=1e9).contains(*gain);
            if let Some(gain) = gains.iter().find(is_gain) {
                return refuse(format!("`{key}` has {gain}; from 0 to 1e9 is allowed"));
            }
        }
        if !(1.0..=1e5).contains(&own.rate_hz) {
            return refuse(format!(
                "`rate_hz` is {}; from 1 to 1e5 is allowed",
                own.rate_hz
            ));
        }
        let corner = own.velocity_lowpass_hz;
        if let Some(corner) = corner.filter(|corner| !(1e-3..=1e6).contains(corner)) {
            return refuse(format!(
                "`velocity_lowpass_hz` is {corner}; from 1e-3 to 1e6 is allowed"
            ));
        }
        Ok(own)
    }

    /// The controller of a device, whose torques are limited as its file says.
    ///
    /// # Errors
    /// As [`RigidBodies::of_device`], where it compensates gravity.
    pub fn of(&self, nominal: &Device) -> Result<Controller, ModelError> {
        let gravity = match self.gravity_compensation {
            true => Some(RigidBodies::of_device(nominal)?),
            false => None,
        };
        Ok(Controller {
            kp: self.kp_nm_per_rad.clone(),
            kd: self.kd_nm_s_per_rad.clone(),
            gravity,
            rate_hz: self.rate_hz,
            velocity_lowpass_hz: self.velocity_lowpass_hz,
            limits: nominal
                .joints
                .iter()
                .map(|joint| joint.torque_limit_nm)
                .collect(),
        })
    }
}
