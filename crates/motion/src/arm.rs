//! The rigid bodies of a device, and the directions in which their numbers may be off.

use haptical_dynamics::{Inertia, Joint, Tree};
use haptical_model::{Device, MotionWork, RigidBodies};
use nalgebra::{Matrix3, Vector3};

use crate::MotionError;
use crate::thresholds::plausible;

/// Inertial parameters of a body.
pub(crate) const PARAMETERS: usize = 10;

/// A direction in the inertial parameters of one body, one plausible standard deviation long.
#[derive(Debug, Clone)]
pub(crate) struct Deviation {
    pub(crate) body: usize,
    pub(crate) parameters: [f64; PARAMETERS],
}

/// A device in motion.
#[derive(Debug, Clone)]
pub(crate) struct Arm {
    pub(crate) bodies: RigidBodies,
    /// Stated armature of each joint \[kg m^2\].
    pub(crate) armature: Vec<Option<f64>>,
    /// The stated one, or what is taken for it where the noise of the positions is weighed \[kg m^2\].
    pub(crate) likely_armature: Vec<f64>,
    /// What each joint's torque reads without any, and how long it is logged before its position \[s\].
    pub(crate) offset: Vec<f64>,
    pub(crate) early_s: Vec<f64>,
    /// Name of each joint's torque in a log.
    pub(crate) torque_columns: Vec<String>,
}

impl Arm {
    /// The bodies of a device, plausible ones where its file lacks them.
    ///
    /// # Errors
    /// As [`RigidBodies::plausible`].
    pub(crate) fn new(device: &Device) -> Result<Self, MotionError> {
        Ok(Self {
            bodies: RigidBodies::plausible(device)?,
            armature: device.joints.iter().map(|own| own.armature_kgm2).collect(),
            likely_armature: (device.joints.iter())
                .map(|own| own.armature_kgm2.unwrap_or(0.0))
                .collect(),
            offset: (device.joints.iter())
                .map(|own| own.torque_offset_nm.unwrap_or(0.0))
                .collect(),
            early_s: (device.joints.iter())
                .map(|own| -own.torque_delay_s.unwrap_or(0.0))
                .collect(),
            torque_columns: (device.joints.iter().zip(1..))
                .map(|(own, number)| own.torque_column(number))
                .collect(),
        })
    }

    pub(crate) fn joints(&self) -> usize {
        self.bodies.joint_count()
    }

    /// Whether a joint slides.
    pub(crate) fn slides(&self, joint: usize) -> bool {
        let is_own = |body: &usize| self.bodies.drive(*body).is_some_and(|own| own.0 == joint);
        let mut own = (0..self.body_count()).filter(is_own);
        own.any(|body| matches!(self.bodies.bodies()[body].joint, Joint::Prismatic(_)))
    }

    pub(crate) fn body_count(&self) -> usize {
        self.bodies.bodies().len()
    }

    pub(crate) fn work(&self) -> MotionWork {
        self.bodies.work()
    }

    /// Nominal inertial parameters of all bodies.
    pub(crate) fn nominal(&self) -> Vec<f64> {
        let masses = self.bodies.masses().iter();
        masses.flat_map(|own| own.inertia.parameters()).collect()
    }

    /// Mass, centre and inertia about it of a body.
    pub(crate) fn about_centre(&self, body: usize) -> (f64, Vector3<f64>, Matrix3<f64>) {
        let own = &self.bodies.masses()[body].inertia;
        let centre_m = own.centre_of_mass_m().unwrap_or_default();
        (own.mass_kg, centre_m, own.about_centre_kgm2())
    }

    /// All directions in which the bodies may be off.
    pub(crate) fn deviations(&self) -> Vec<Deviation> {
        let mut found = Vec::new();
        for (body, own) in self.bodies.masses().iter().enumerate() {
            let (mass_kg, centre_m, inertia) = self.about_centre(body);
            if mass_kg <= 0.0 {
                continue;
            }
            let pick =
                |given: bool, stated: f64, assumed: f64| 0.5 * if given { stated } else { assumed };
            let share = pick(own.has_mass, plausible::MASS, plausible::ASSUMED_MASS);
            let reach_m = pick(
                own.has_centre,
                plausible::CENTRE_M,
                plausible::ASSUMED_CENTRE_M,
            );
            let spread = pick(
                own.has_inertia,
                plausible::INERTIA,
                plausible::ASSUMED_INERTIA,
            );
            let mut add = |parameters| found.push(Deviation { body, parameters });
            add(own.inertia.parameters().map(|value| share * value));
            for axis in 0..3 {
                let mut shift = Vector3::zeros();
                shift[axis] = reach_m;
                let at =
                    |centre_m| Inertia::about_centre(mass_kg, &centre_m, &inertia).parameters();
                let (ahead, behind) = (at(centre_m + shift), at(centre_m - shift));
                // the parameters are quadratic in the centre: the central difference is the derivative
                add(std::array::from_fn(|k| 0.5 * (ahead[k] - behind[k])));
            }
            for (row, column) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)] {
                let mut change = Matrix3::zeros();
                let size = spread
                    * (inertia[(row, row)] * inertia[(column, column)])
                        .abs()
                        .sqrt();
                change[(row, column)] = size;
                change[(column, row)] = size;
                let own = Inertia::about_centre(0.0, &Vector3::zeros(), &change);
                add(own.parameters());
            }
        }
        found
    }

    /// Torques at rest under a gravity of 1 m/s^2 along each axis of frame (-1), joint by joint.
    ///
    /// # Errors
    /// [`MotionError`] for positions at which there are none.
    pub(crate) fn under_gravity(&self, q: &[f64]) -> Result<[Vec<f64>; 3], MotionError> {
        let bodies = self.bodies.bodies();
        let drive = |body: usize| self.bodies.drive(body).unwrap_or((0, 0.0));
        let rows: Vec<f64> = (0..bodies.len())
            .map(|body| {
                let (joint, multiplier) = drive(body);
                multiplier * q[joint]
            })
            .collect();
        let still = vec![0.0; bodies.len()];
        let mut scratch = vec![haptical_dynamics::Scratch::default(); bodies.len()];
        let mut found = [0, 1, 2].map(|_| vec![0.0; self.joints()]);
        for (axis, torques) in found.iter_mut().enumerate() {
            let mut gravity = Vector3::zeros();
            gravity[axis] = 1.0;
            let tree = Tree::new(bodies, gravity).map_err(haptical_model::ModelError::from)?;
            let mut torque = vec![0.0; bodies.len()];
            tree.inverse_dynamics(&rows, &still, &still, &[], &mut scratch, &mut torque)
                .map_err(haptical_model::ModelError::from)?;
            for (body, torque) in torque.iter().enumerate() {
                let (joint, multiplier) = drive(body);
                torques[joint] += multiplier * torque;
            }
        }
        Ok(found)
    }
}
