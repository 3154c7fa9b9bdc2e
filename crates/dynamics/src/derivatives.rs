//! Derivatives of inverse dynamics by positions and velocities.

use nalgebra::{Matrix3, Vector3};

use crate::inertia::second_moments;
use crate::spatial::{Force, Motion};
use crate::tree::{check_length, check_result};
use crate::{DynamicsError, Inertia, Scratch, Tree};

/// How the torques of a motion change with it, row by row: entry `i n + j` is that of torque i by joint j.
///
/// The derivative by `ddq` is [`Tree::mass_matrix`].
#[derive(Debug)]
pub struct TorqueDerivatives<'o> {
    /// By positions, n x n entries.
    pub by_q: &'o mut [f64],
    /// By velocities, n x n entries.
    pub by_dq: &'o mut [f64],
}

impl Tree<'_> {
    /// Derivatives of [`Tree::inverse_dynamics`] without wrenches by `q` and by `dq`.
    ///
    /// Source: Carpentier & Mansard, *Analytical Derivatives of Rigid Body Dynamics Algorithms*, RSS 2018; in
    /// the form of Singh, Russo & Wensing, IEEE RA-L 7(2), 2022; derived in docs/equations.md,
    /// Rigid-body dynamics. Nothing is approximated, and no matrix is larger than 3x3.
    ///
    /// ```
    /// # use haptical_dynamics::nalgebra::{Matrix3, Vector3};
    /// use haptical_dynamics::TorqueDerivatives;
    /// # use haptical_dynamics::{Body, Inertia, Joint, Pose, Scratch, Tree};
    /// # let bob_m = Vector3::new(0.0, 0.0, -0.5);
    /// # let bodies = [Body {
    /// #     parent: None,
    /// #     placement: Pose::default(),
    /// #     joint: Joint::Revolute(Vector3::y_axis()),
    /// #     inertia: Inertia::about_centre(2.0, &bob_m, &Matrix3::zeros()),
    /// #     armature_kgm2: 0.0,
    /// # }];
    /// // A pendulum, 2 kg at 0.5 m: tau = m l^2 ddq + m g l sin q
    /// let tree = Tree::new(&bodies, Vector3::new(0.0, 0.0, -9.81))?;
    /// let (mut scratch, mut by_q, mut by_dq) = ([Scratch::default()], [0.0], [0.0]);
    /// let out = TorqueDerivatives { by_q: &mut by_q, by_dq: &mut by_dq };
    /// tree.torque_derivatives(&[0.3], &[2.0], &[4.0], &mut scratch, out)?;
    /// assert!((by_q[0] - 9.81 * 0.3f64.cos()).abs() < 1e-14);
    /// assert!(by_dq[0].abs() < 1e-15);
    /// # Ok::<(), haptical_dynamics::DynamicsError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`DynamicsError::Length`], [`DynamicsError::NonFiniteJoint`], [`DynamicsError::Overflow`].
    pub fn torque_derivatives(
        &self,
        q: &[f64],
        dq: &[f64],
        ddq: &[f64],
        scratch: &mut [Scratch],
        out: TorqueDerivatives<'_>,
    ) -> Result<(), DynamicsError> {
        let count = self.bodies().len();
        let TorqueDerivatives { by_q, by_dq } = out;
        check_length("the derivative by positions", count * count, by_q.len())?;
        check_length("the derivative by velocities", count * count, by_dq.len())?;
        self.move_to(q, dq, Some(ddq), scratch)?;
        for index in 0..count {
            let (velocity, acceleration) = self.carried(index, scratch);
            scratch[index].differentiate(&velocity, &acceleration);
        }
        by_q.fill(0.0);
        by_dq.fill(0.0);
        for index in (0..count).rev() {
            let own = &scratch[index];
            let [rate, second] = &own.screw_rates;
            let inert = own.inertia.times(&own.screw);
            let drifting = own.drifting_on(&own.screw);
            let moved = own.screw.cross_force(&own.force);
            let moved = moved.plus(&own.inertia.times(second));
            let moved = moved.plus(&own.drifting(rate));
            let sped = own.drifting(&own.screw);
            let sped = sped.plus_scaled(2.0, &own.inertia.times(rate));
            for joint in self.path(index) {
                let other = &scratch[joint];
                let [rate, second] = &other.screw_rates;
                by_q[joint * count + index] = other.screw.dot(&moved);
                by_dq[joint * count + index] = other.screw.dot(&sped);
                if joint != index {
                    by_q[index * count + joint] = second.dot(&inert) + rate.angular.dot(&drifting);
                    by_dq[index * count + joint] =
                        2.0 * rate.dot(&inert) + other.screw.angular.dot(&drifting);
                }
            }
            if let Some(parent) = self.bodies()[index].parent {
                let Scratch {
                    inertia,
                    force,
                    momentum,
                    drift,
                    ..
                } = scratch[index];
                let parent = &mut scratch[parent];
                parent.inertia += inertia;
                parent.force = parent.force.plus(&force);
                parent.momentum += momentum;
                parent.drift += drift;
            }
        }
        check_result("the derivative by positions", by_q)?;
        check_result("the derivative by velocities", by_dq)
    }
}

impl Scratch {
    /// What the derivatives need of the body alone; its parent has this velocity and acceleration.
    fn differentiate(&mut self, velocity: &Motion, acceleration: &Motion) {
        let rate = velocity.cross(&self.screw);
        let second = acceleration.cross(&self.screw);
        self.screw_rates = [rate, second.plus(&velocity.cross(&rate))];
        let momentum = self.inertia.times(&self.velocity);
        let force = self.inertia.times(&self.acceleration);
        self.force = force.plus(&self.velocity.cross_force(&momentum));
        self.momentum = momentum.force;
        self.drift = drift(&self.inertia, &self.velocity);
    }

    /// `D x`: the force per change `x` of a velocity that the whole of the body shares.
    fn drifting(&self, motion: &Motion) -> Force {
        Force {
            force: motion.angular.cross(&self.momentum) * 2.0,
            moment: self.drift * motion.angular,
        }
    }

    /// `D^T x`, whose linear part is 0.
    fn drifting_on(&self, motion: &Motion) -> Vector3<f64> {
        self.momentum.cross(&motion.linear) * 2.0 + self.drift.tr_mul(&motion.angular)
    }
}

/// `2 ((h . u) 1 - u h^T - [w] Sigma)` at the velocity (u, w) of a body with the first moment h and the second moments
/// Sigma.
fn drift(inertia: &Inertia, velocity: &Motion) -> Matrix3<f64> {
    let (h, u) = (&inertia.first_moment_kgm, &velocity.linear);
    let turned = velocity.angular.cross_matrix() * second_moments(&inertia.about_origin_kgm2);
    (Matrix3::from_diagonal_element(h.dot(u)) - u * h.transpose() - turned) * 2.0
}
