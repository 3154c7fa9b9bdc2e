//! Forward dynamics: the accelerations that torques make.

use crate::articulated::Articulated;
use crate::passes::at_base;
use crate::spatial::Motion;
use crate::tree::{check_length, check_result};
use crate::{DynamicsError, Scratch, Tree, Wrench};

/// Inertia about a joint's axis, per size of the terms that cancel in it, below which it is rounding.
const ROUNDING: f64 = 1e-14;

impl Tree<'_> {
    /// Accelerations of the joints under the torques `tau` and the wrenches of the surroundings:
    /// `M ddq = tau - b + sum J^T w`, without forming M.
    ///
    /// `out` has one entry per joint. Source: articulated bodies, Featherstone (2008) table 7.1, along the base's
    /// axes, with armatures on the joints' own inertias.
    ///
    /// ```
    /// use haptical_dynamics::nalgebra::{Matrix3, Vector3};
    /// use haptical_dynamics::{Body, Inertia, Joint, Pose, Scratch, Tree};
    /// let wheel = Inertia::about_centre(1.0, &Vector3::zeros(), &(0.2 * Matrix3::identity()));
    /// let bodies = [Body {
    ///     parent: None,
    ///     placement: Pose::default(),
    ///     joint: Joint::Revolute(Vector3::x_axis()),
    ///     inertia: wheel,
    ///     armature_kgm2: 0.05,
    /// }];
    /// let tree = Tree::new(&bodies, Vector3::zeros())?;
    /// let (mut scratch, mut acceleration) = ([Scratch::default()], [0.0]);
    /// tree.forward_dynamics(&[1.0], &[3.0], &[0.5], &[], &mut scratch, &mut acceleration)?;
    /// assert!((acceleration[0] - 2.0).abs() < 1e-15);
    /// # Ok::<(), haptical_dynamics::DynamicsError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`DynamicsError::NoInertia`] for a joint that moves nothing with inertia about its axis;
    /// [`DynamicsError::Length`], [`DynamicsError::NonFiniteJoint`], [`DynamicsError::WrenchBody`],
    /// [`DynamicsError::NonFiniteVector`], [`DynamicsError::Overflow`].
    pub fn forward_dynamics(
        &self,
        q: &[f64],
        dq: &[f64],
        tau: &[f64],
        wrenches: &[Wrench],
        scratch: &mut [Scratch],
        out: &mut [f64],
    ) -> Result<(), DynamicsError> {
        self.check_joints("torque", tau)?;
        self.check_wrenches(wrenches)?;
        check_length("the slice of accelerations", self.bodies().len(), out.len())?;
        self.move_to(q, dq, None, scratch)?;
        for own in scratch.iter_mut() {
            let momentum = own.inertia.times(&own.velocity);
            let bias = own.velocity.cross_force(&momentum);
            own.articulated = Articulated::new(&own.inertia, bias);
        }
        for wrench in wrenches {
            let force = at_base(wrench, scratch);
            let own = &mut scratch[wrench.body].articulated;
            own.bias = own.bias.plus_scaled(-1.0, &force);
        }
        for (index, body) in self.bodies().iter().enumerate().rev() {
            let own = &mut scratch[index];
            let column = own.articulated.times(&own.screw);
            let pivot = own.screw.dot(&column) + body.armature_kgm2;
            let size = own.articulated.size(&own.screw);
            // not `<=`: a NaN is caught as well
            let resists = pivot > ROUNDING * size;
            if !resists {
                return Err(DynamicsError::NoInertia { joint: index });
            }
            own.articulated.column = column;
            own.articulated.pivot = pivot;
            own.articulated.torque = tau[index] - own.screw.dot(&own.articulated.bias);
            if let Some(parent) = body.parent {
                let change = self.change(index, dq, scratch);
                let felt = scratch[index].articulated.behind_joint(&change);
                scratch[parent].articulated.add(&felt);
            }
        }
        for index in 0..self.bodies().len() {
            let change = self.change(index, dq, scratch);
            let carried = self.carried(index, scratch).1.plus(&change);
            let own = &mut scratch[index];
            let Articulated {
                column,
                pivot,
                torque,
                ..
            } = own.articulated;
            out[index] = (torque - carried.dot(&column)) / pivot;
            own.acceleration = carried.plus_scaled(out[index], &own.screw);
        }
        check_result("an acceleration", out)
    }

    /// The acceleration that a joint's velocity adds to that of its parent, `v x S dq`.
    fn change(&self, index: usize, dq: &[f64], scratch: &[Scratch]) -> Motion {
        let own = &scratch[index];
        let change = own.velocity.cross(&own.screw);
        Motion::default().plus_scaled(dq[index], &change)
    }
}
