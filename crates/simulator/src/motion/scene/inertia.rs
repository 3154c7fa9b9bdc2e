//! Torques that move the links: inverse dynamics without weights.

use haptical_model::{Device, ModelError, MotionWork, RigidBodies};

use crate::JointMotion;

/// The moving links of a device and what moves them now; nothing of a device without links.
#[derive(Debug, Clone)]
pub(crate) struct Inertias {
    bodies: Option<(RigidBodies, MotionWork)>,
    positions: Vec<f64>,
    rates: Vec<f64>,
    accelerations: Vec<f64>,
    still: Vec<f64>,
    weights_nm: Vec<f64>,
    torques_nm: Vec<f64>,
}

impl Inertias {
    /// A link whose mass the device file does not give has none here, as it has no weight; one whose inertia it does not
    /// give has that of a rod (assumption A150).
    pub(crate) fn new(device: &Device) -> Result<Self, ModelError> {
        let joints = device.joints.len();
        let bodies = match device.has_links() {
            false => None,
            true => {
                let all = RigidBodies::plausible(device)?;
                let masses = all.masses().iter();
                let known = masses.map(|row| match row.has_mass {
                    true => row.inertia,
                    false => Default::default(),
                });
                let bodies = all.with_inertias(&known.collect::<Vec<_>>())?;
                let work = bodies.work();
                Some((bodies, work))
            }
        };
        let zero = vec![0.0; joints];
        Ok(Self {
            bodies,
            positions: zero.clone(),
            rates: zero.clone(),
            accelerations: zero.clone(),
            still: zero.clone(),
            weights_nm: zero.clone(),
            torques_nm: zero,
        })
    }

    /// Moves a joint (from 0) to an output, at the rates of the hand's way.
    pub(crate) fn move_joint(&mut self, joint: usize, output: f64, motion: &JointMotion) {
        self.positions[joint] = output;
        self.rates[joint] = motion.velocity;
        self.accelerations[joint] = motion.acceleration;
    }

    /// Torque of each joint's drive.
    pub(crate) fn torques_nm(&mut self) -> Result<&[f64], ModelError> {
        if let Some((bodies, work)) = &mut self.bodies {
            let (torques_nm, weights_nm) = (&mut self.torques_nm, &mut self.weights_nm);
            let (at, still) = (&self.positions, &self.still);
            bodies.torques(at, &self.rates, &self.accelerations, work, torques_nm)?;
            bodies.torques(at, still, still, work, weights_nm)?;
            for (torque, weight) in torques_nm.iter_mut().zip(weights_nm) {
                *torque -= *weight;
            }
        }
        Ok(&self.torques_nm)
    }
}
