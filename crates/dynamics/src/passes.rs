//! Works out places, velocities and accelerations, from the base outwards.

use haptical_kinematics::Pose;
use nalgebra::{Matrix3, Vector3};

use crate::spatial::{Force, Motion};
use crate::{DynamicsError, Joint, Scratch, Tree, Wrench};

/// `1 + sin(q) [a] + (1 - cos(q)) [a]^2`: Rodrigues.
fn turn(axis: &Vector3<f64>, angle: f64) -> Matrix3<f64> {
    let (sine, cosine) = libm::sincos(angle);
    let along = axis * axis.transpose() * (1.0 - cosine);
    Matrix3::from_diagonal_element(cosine) + along + axis.cross_matrix() * sine
}

impl Tree<'_> {
    /// Places, inertias, velocities and accelerations of all bodies in a motion; without `ddq` the joints do not accelerate.
    ///
    /// # Errors
    ///
    /// [`DynamicsError::Length`], [`DynamicsError::NonFiniteJoint`].
    pub(crate) fn move_to(
        &self,
        q: &[f64],
        dq: &[f64],
        ddq: Option<&[f64]>,
        scratch: &mut [Scratch],
    ) -> Result<(), DynamicsError> {
        self.check_joints("position", q)?;
        self.check_joints("velocity", dq)?;
        if let Some(ddq) = ddq {
            self.check_joints("acceleration", ddq)?;
        }
        self.check_scratch(scratch)?;
        self.place(q, scratch);
        self.weigh(scratch);
        self.accelerate(dq, ddq, scratch);
        Ok(())
    }

    /// Poses, and screws along the base's axes, about its origin.
    pub(crate) fn place(&self, q: &[f64], scratch: &mut [Scratch]) {
        for (index, body) in self.bodies().iter().enumerate() {
            let base = match body.parent {
                Some(parent) => scratch[parent].pose,
                None => Pose::default(),
            };
            let mut pose = Pose {
                position_m: base.position_m + base.rotation * body.placement.position_m,
                rotation: base.rotation * body.placement.rotation,
            };
            let axis = pose.rotation * body.joint.axis().into_inner();
            let screw = match &body.joint {
                Joint::Revolute(own) => {
                    pose.rotation *= turn(own, q[index]);
                    Motion {
                        linear: pose.position_m.cross(&axis),
                        angular: axis,
                    }
                }
                Joint::Prismatic(_) => {
                    pose.position_m += axis * q[index];
                    Motion {
                        linear: axis,
                        angular: Vector3::zeros(),
                    }
                }
            };
            let own = &mut scratch[index];
            own.pose = pose;
            own.screw = screw;
        }
    }

    /// Inertias along the base's axes, about its origin, after [`Tree::place`].
    pub(crate) fn weigh(&self, scratch: &mut [Scratch]) {
        for (own, body) in scratch.iter_mut().zip(self.bodies()) {
            own.inertia = body.inertia.seen_from(&own.pose);
        }
    }

    /// Velocities and accelerations, after [`Tree::place`]; without `ddq` those of joints that do not accelerate.
    pub(crate) fn accelerate(&self, dq: &[f64], ddq: Option<&[f64]>, scratch: &mut [Scratch]) {
        for index in 0..scratch.len() {
            let (velocity, acceleration) = self.carried(index, scratch);
            let own = &mut scratch[index];
            own.velocity = velocity.plus_scaled(dq[index], &own.screw);
            // v x S dq is v_parent x S dq: S x S = 0
            let change = velocity.cross(&own.screw);
            own.acceleration = acceleration.plus_scaled(dq[index], &change);
            if let Some(ddq) = ddq {
                own.acceleration = own.acceleration.plus_scaled(ddq[index], &own.screw);
            }
        }
    }

    /// Velocity and acceleration of what a body hangs on.
    pub(crate) fn carried(&self, body: usize, scratch: &[Scratch]) -> (Motion, Motion) {
        match self.bodies()[body].parent {
            Some(parent) => (scratch[parent].velocity, scratch[parent].acceleration),
            None => (Motion::default(), self.base_acceleration()),
        }
    }

    /// Gravity acts as an acceleration of the base: Featherstone (2008), section 5.3.
    pub(crate) fn base_acceleration(&self) -> Motion {
        Motion {
            linear: -self.gravity_mps2(),
            angular: Vector3::zeros(),
        }
    }
}

/// A wrench with its moment about the base's origin.
pub(crate) fn at_base(wrench: &Wrench, scratch: &[Scratch]) -> Force {
    let pose = &scratch[wrench.body].pose;
    let place_m = pose.position_m + pose.rotation * wrench.point_m;
    Force {
        force: wrench.force_n,
        moment: wrench.moment_nm + place_m.cross(&wrench.force_n),
    }
}
