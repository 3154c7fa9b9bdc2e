//! Inverse dynamics: the torques that a motion needs.

use crate::passes::at_base;
use crate::tree::{check_length, check_result};
use crate::{DynamicsError, Scratch, Tree, Wrench};

impl Tree<'_> {
    /// Torques that give the joints the accelerations `ddq`: `tau = M ddq + b - sum J^T w`, where the
    /// wrenches `w` of the surroundings help.
    ///
    /// `out` has one entry per joint. Source: recursive Newton-Euler, Featherstone (2008) table 5.1 (Luh,
    /// Walker & Paul 1980), along the base's axes; docs/equations.md, Rigid-body dynamics.
    ///
    /// ```
    /// use haptical_dynamics::nalgebra::Vector3;
    /// use haptical_dynamics::{Body, Inertia, Joint, Pose, Scratch, Tree, Wrench};
    /// // A lift of 3 kg with a motor that adds 1 kg; someone pulls it up with 5 N.
    /// let bodies = [Body {
    ///     parent: None,
    ///     placement: Pose::default(),
    ///     joint: Joint::Prismatic(Vector3::z_axis()),
    ///     inertia: Inertia { mass_kg: 3.0, ..Inertia::default() },
    ///     armature_kgm2: 1.0,
    /// }];
    /// let tree = Tree::new(&bodies, Vector3::new(0.0, 0.0, -10.0))?;
    /// let (force_n, zero) = (Vector3::new(0.0, 0.0, 5.0), Vector3::zeros());
    /// let wrenches = [Wrench { body: 0, point_m: zero, force_n, moment_nm: zero }];
    /// let (mut scratch, mut force) = ([Scratch::default()], [0.0]);
    /// tree.inverse_dynamics(&[0.2], &[0.1], &[2.0], &wrenches, &mut scratch, &mut force)?;
    /// assert_eq!(force, [3.0 * 10.0 + 4.0 * 2.0 - 5.0]);
    /// # Ok::<(), haptical_dynamics::DynamicsError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`DynamicsError::Length`] for a slice that has not one entry per joint,
    /// [`DynamicsError::NonFiniteJoint`], [`DynamicsError::WrenchBody`],
    /// [`DynamicsError::NonFiniteVector`], [`DynamicsError::Overflow`].
    pub fn inverse_dynamics(
        &self,
        q: &[f64],
        dq: &[f64],
        ddq: &[f64],
        wrenches: &[Wrench],
        scratch: &mut [Scratch],
        out: &mut [f64],
    ) -> Result<(), DynamicsError> {
        self.torques(q, dq, Some(ddq), wrenches, scratch, out)
    }

    /// Torques of a motion without acceleration of the joints, `b(q, dq)`: gravity, Coriolis and centrifugal
    /// torques.
    ///
    /// # Errors
    ///
    /// As [`Tree::inverse_dynamics`].
    pub fn bias_forces(
        &self,
        q: &[f64],
        dq: &[f64],
        scratch: &mut [Scratch],
        out: &mut [f64],
    ) -> Result<(), DynamicsError> {
        self.torques(q, dq, None, &[], scratch, out)
    }

    fn torques(
        &self,
        q: &[f64],
        dq: &[f64],
        ddq: Option<&[f64]>,
        wrenches: &[Wrench],
        scratch: &mut [Scratch],
        out: &mut [f64],
    ) -> Result<(), DynamicsError> {
        self.check_wrenches(wrenches)?;
        check_length("the slice of torques", self.bodies().len(), out.len())?;
        self.move_to(q, dq, ddq, scratch)?;
        for own in scratch.iter_mut() {
            let momentum = own.inertia.times(&own.velocity);
            let force = own.inertia.times(&own.acceleration);
            own.force = force.plus(&own.velocity.cross_force(&momentum));
        }
        for wrench in wrenches {
            let force = at_base(wrench, scratch);
            let own = &mut scratch[wrench.body];
            own.force = own.force.plus_scaled(-1.0, &force);
        }
        for (index, body) in self.bodies().iter().enumerate().rev() {
            let Scratch { force, screw, .. } = scratch[index];
            out[index] = screw.dot(&force) + body.armature_kgm2 * ddq.map_or(0.0, |ddq| ddq[index]);
            if let Some(parent) = body.parent {
                scratch[parent].force = scratch[parent].force.plus(&force);
            }
        }
        check_result("a torque", out)
    }
}
