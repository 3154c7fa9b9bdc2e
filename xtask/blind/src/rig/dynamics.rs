//! Torques that the drives exert on the links: inverse dynamics of the chain less the hand's force.

use haptical_model::Device;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};

use crate::rig::geometry::{link_rotation_after_axis, turn_z};

/// Radius of gyration of a body about its centre, taken as a ball's \[m\].
const GYRATION_RADIUS_M: f64 = 0.03;

/// Recursive Newton-Euler inverse dynamics of a chain of revolute joints.
///
/// Source: Luh, Walker & Paul, "On-line computational scheme for mechanical manipulators", 1980; the
/// bodies are balls, so that the gyroscopic term vanishes. All vectors are in frame (-1).
#[derive(Debug)]
pub struct Dynamics<'d> {
    device: &'d Device,
    gravity_mps2: Vector3<f64>,
    rows: Vec<Row>,
}

/// What the outward pass leaves for the inward one, per joint.
#[derive(Debug, Clone, Copy)]
struct Row {
    axis: Vector3<f64>,
    origin_m: Vector3<f64>,
    centre_m: Vector3<f64>,
    force_n: Vector3<f64>,
    moment_nm: Vector3<f64>,
}

impl<'d> Dynamics<'d> {
    /// Prepares for a device; rows without a body have no mass.
    pub fn new(device: &'d Device) -> Self {
        Self {
            device,
            gravity_mps2: device
                .gravity_mps2
                .map_or_else(Vector3::zeros, Vector3::from),
            rows: Vec::with_capacity(device.joints.len()),
        }
    }

    /// Joint torques of the drives \[N m\], written to `torque_nm`, at angles from home, rates and
    /// accelerations, with the force of the hand on the handle in the handle's frame \[N\].
    ///
    /// Positive along +theta: `torque = M(q) q'' + C(q, q') + g(q) - J^T F_hand`. Returns the moment of
    /// the base on the first link about its joint, in the base's frame \[N m\].
    pub fn torques_nm(
        &mut self,
        angle_rad: &[f64],
        rate_rad_s: &[f64],
        acceleration_rad_s2: &[f64],
        hand_force_n: [f64; 3],
        torque_nm: &mut [f64],
    ) -> [f64; 3] {
        let device = self.device;
        let mut rotation: Matrix3<f64> = Matrix3::identity();
        let mut base = rotation;
        let mut origin_m = Vector3::zeros();
        let (mut spin, mut spin_rate) = (Vector3::zeros(), Vector3::zeros());
        let mut acceleration: Vector3<f64> = Vector3::zeros();
        self.rows.clear();
        for (index, link) in device.links.iter().enumerate() {
            let mut angle = link.theta_rad;
            let axis: Vector3<f64> = rotation.column(2).into_owned();
            if index > 0 {
                let joint = index - 1;
                angle += device.joints[joint].home_rad + angle_rad[joint];
                spin_rate +=
                    axis * acceleration_rad_s2[joint] + spin.cross(&axis) * rate_rad_s[joint];
                spin += axis * rate_rad_s[joint];
            }
            let turned = rotation * turn_z(angle);
            let carry = |arm: &Vector3<f64>| {
                acceleration + spin_rate.cross(arm) + spin.cross(&spin.cross(arm))
            };
            if index > 0 {
                let body = device.bodies.get(index).copied().flatten();
                let (mass_kg, arm) = body.map_or((0.0, Vector3::zeros()), |body| {
                    (body.mass_kg, turned * Vector3::from(body.centre_of_mass_m))
                });
                self.rows.push(Row {
                    axis,
                    origin_m,
                    centre_m: origin_m + arm,
                    force_n: (carry(&arm) - self.gravity_mps2) * mass_kg,
                    moment_nm: spin_rate * (mass_kg * GYRATION_RADIUS_M * GYRATION_RADIUS_M),
                });
            }
            let arm = turned * Vector3::new(link.a_m, 0.0, link.d_m);
            acceleration = carry(&arm);
            origin_m += arm;
            rotation = turned * link_rotation_after_axis(link);
            if index == 0 {
                base = rotation;
            }
        }
        let mut force_n = -(rotation * Vector3::from(hand_force_n));
        let mut moment_nm = Vector3::zeros();
        let mut next_m = origin_m;
        for (row, torque) in self.rows.iter().zip(torque_nm).rev() {
            moment_nm += (next_m - row.origin_m).cross(&force_n)
                + (row.centre_m - row.origin_m).cross(&row.force_n)
                + row.moment_nm;
            force_n += row.force_n;
            next_m = row.origin_m;
            *torque = moment_nm.dot(&row.axis);
        }
        (base.transpose() * moment_nm).into()
    }
}
