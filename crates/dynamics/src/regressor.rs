//! The regressor: how torques depend on the inertial parameters.

use nalgebra::Vector3;

use crate::tree::{check_length, check_result};
use crate::{DynamicsError, Scratch, Tree};

/// Inertial parameters of a body.
const PARAMETERS: usize = 10;

/// A body's turning and the acceleration of its frame's origin, along its own axes.
struct Turning {
    velocity: Vector3<f64>,
    acceleration: Vector3<f64>,
    origin: Vector3<f64>,
}

impl Tree<'_> {
    /// The matrix `Y(q, dq, ddq)` with `tau = Y pi`, row by row: n x 10 n entries.
    ///
    /// `pi` are the [`parameters`](crate::Inertia::parameters) of body 0, then those of body 1, ...; armatures are not
    /// among them: joint i has `ddq_i` in its own column. A joint's row has other numbers than 0 only for the bodies
    /// that it carries. The bodies' own inertias are not looked at. Source: Atkeson, An & Hollerbach (1986); Siciliano et al.
    /// (2009), section 7.2.2; docs/equations.md, Rigid-body dynamics.
    ///
    /// ```
    /// # use haptical_dynamics::nalgebra::{Matrix3, Vector3};
    /// # use haptical_dynamics::{Body, Inertia, Joint, Pose, Scratch, Tree};
    /// # let bodies = [Body {
    /// #     parent: None,
    /// #     placement: Pose::default(),
    /// #     joint: Joint::Revolute(Vector3::z_axis()),
    /// #     inertia: Inertia::default(),
    /// #     armature_kgm2: 0.0,
    /// # }];
    /// // One joint about z, gravity along -y.
    /// let tree = Tree::new(&bodies, Vector3::new(0.0, -9.81, 0.0))?;
    /// let (mut scratch, mut row) = ([Scratch::default()], [0.0; 10]);
    /// tree.regressor(&[0.0], &[1.0], &[3.0], &mut scratch, &mut row)?;
    /// assert_eq!(row, [0.0, 9.81, 0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0]);
    /// # Ok::<(), haptical_dynamics::DynamicsError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`DynamicsError::Length`], [`DynamicsError::NonFiniteJoint`], [`DynamicsError::Overflow`].
    pub fn regressor(
        &self,
        q: &[f64],
        dq: &[f64],
        ddq: &[f64],
        scratch: &mut [Scratch],
        out: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let count = self.bodies().len();
        self.check_joints("position", q)?;
        self.check_joints("velocity", dq)?;
        self.check_joints("acceleration", ddq)?;
        self.check_scratch(scratch)?;
        let columns = PARAMETERS * count;
        check_length("the regressor", count * columns, out.len())?;
        self.place(q, scratch);
        self.accelerate(dq, Some(ddq), scratch);
        out.fill(0.0);
        for body in 0..count {
            let own = &scratch[body];
            let (place_m, rotation) = (&own.pose.position_m, &own.pose.rotation);
            let turning = own.turning();
            for joint in self.path(body) {
                let screw = &scratch[joint].screw;
                let linear = rotation.tr_mul(&(screw.linear + screw.angular.cross(place_m)));
                let angular = rotation.tr_mul(&screw.angular);
                let start = joint * columns + PARAMETERS * body;
                let entries = turning.torques(&linear, &angular);
                out[start..start + PARAMETERS].copy_from_slice(&entries);
            }
        }
        check_result("the regressor", out)
    }
}

impl Scratch {
    fn turning(&self) -> Turning {
        let (place_m, rotation) = (&self.pose.position_m, &self.pose.rotation);
        let (velocity, acceleration) = (&self.velocity, &self.acceleration);
        // from the point of the body at the base's origin to that at its own, and to its path there
        let speed = velocity.linear + velocity.angular.cross(place_m);
        let origin = acceleration.linear
            + acceleration.angular.cross(place_m)
            + velocity.angular.cross(&speed);
        Turning {
            velocity: rotation.tr_mul(&velocity.angular),
            acceleration: rotation.tr_mul(&acceleration.angular),
            origin: rotation.tr_mul(&origin),
        }
    }
}

impl Turning {
    /// Torques of a joint per parameter of the body: the joint moves the body's origin by `linear` and turns it by
    /// `angular`, both along the body's axes.
    fn torques(&self, linear: &Vector3<f64>, angular: &Vector3<f64>) -> [f64; PARAMETERS] {
        let (w, a) = (&self.velocity, &self.acceleration);
        // force m a_0 + a x h + w x (w x h), moment h x a_0 + I a + w x I w
        let first = linear.cross(a) + linear.cross(w).cross(w) + self.origin.cross(angular);
        // angular . (w x I w) = (angular x w) . I w
        let u = angular.cross(w);
        let diagonal = angular.component_mul(a) + u.component_mul(w);
        let beside =
            |i: usize, j: usize| angular[i] * a[j] + angular[j] * a[i] + u[i] * w[j] + u[j] * w[i];
        [
            linear.dot(&self.origin),
            first.x,
            first.y,
            first.z,
            diagonal.x,
            diagonal.y,
            diagonal.z,
            beside(0, 1),
            beside(0, 2),
            beside(1, 2),
        ]
    }
}
