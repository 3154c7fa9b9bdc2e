//! The mass matrix, and the energies.

use crate::tree::{check_length, check_result};
use crate::{DynamicsError, Scratch, Tree};

impl Tree<'_> {
    /// The mass matrix `M(q)` of all joints, armatures on its diagonal, row by row: n x n entries.
    ///
    /// It is symmetric to the bit, and the derivative of [`Tree::inverse_dynamics`] by `ddq`. Source:
    /// composite rigid bodies, Featherstone (2008) table 6.2; along the base's axes the inertia of all
    /// that a joint carries is a sum.
    ///
    /// ```
    /// # use haptical_dynamics::nalgebra::{Matrix3, Vector3};
    /// # use haptical_dynamics::{Body, Inertia, Joint, Pose, Scratch, Tree};
    /// // Two links of 1 m with 1 kg at their ends, turning about z; the elbow at a right angle.
    /// let end_m = Vector3::new(1.0, 0.0, 0.0);
    /// let link = |parent, x_m| Body {
    ///     parent,
    ///     placement: Pose { position_m: Vector3::new(x_m, 0.0, 0.0), ..Pose::default() },
    ///     joint: Joint::Revolute(Vector3::z_axis()),
    ///     inertia: Inertia::about_centre(1.0, &end_m, &Matrix3::zeros()),
    ///     armature_kgm2: 0.0,
    /// };
    /// let bodies = [link(None, 0.0), link(Some(0), 1.0)];
    /// let tree = Tree::new(&bodies, Vector3::zeros())?;
    /// let (mut scratch, mut mass) = ([Scratch::default(); 2], [0.0; 4]);
    /// tree.mass_matrix(&[0.1, core::f64::consts::FRAC_PI_2], &mut scratch, &mut mass)?;
    /// for (entry, expected) in mass.iter().zip([3.0, 1.0, 1.0, 1.0]) {
    ///     assert!((entry - expected).abs() < 1e-15);
    /// }
    /// # Ok::<(), haptical_dynamics::DynamicsError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`DynamicsError::Length`], [`DynamicsError::NonFiniteJoint`], [`DynamicsError::Overflow`].
    pub fn mass_matrix(
        &self,
        q: &[f64],
        scratch: &mut [Scratch],
        out: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let count = self.bodies().len();
        self.check_joints("position", q)?;
        self.check_scratch(scratch)?;
        check_length("the mass matrix", count * count, out.len())?;
        self.place(q, scratch);
        self.weigh(scratch);
        out.fill(0.0);
        for (index, body) in self.bodies().iter().enumerate().rev() {
            let Scratch { inertia, screw, .. } = scratch[index];
            let force = inertia.times(&screw);
            for joint in self.path(index) {
                let entry = scratch[joint].screw.dot(&force);
                out[index * count + joint] = entry;
                out[joint * count + index] = entry;
            }
            out[index * count + index] += body.armature_kgm2;
            if let Some(parent) = body.parent {
                scratch[parent].inertia += inertia;
            }
        }
        check_result("the mass matrix", out)
    }

    /// Kinetic energy, `dq^T M dq / 2` \[J\]; armatures count.
    ///
    /// # Errors
    ///
    /// [`DynamicsError::Length`], [`DynamicsError::NonFiniteJoint`], [`DynamicsError::Overflow`].
    pub fn kinetic_energy_j(
        &self,
        q: &[f64],
        dq: &[f64],
        scratch: &mut [Scratch],
    ) -> Result<f64, DynamicsError> {
        self.move_to(q, dq, None, scratch)?;
        let bodies = scratch.iter().zip(self.bodies()).zip(dq);
        let twice = bodies.map(|((own, body), dq)| {
            let momentum = own.inertia.times(&own.velocity);
            own.velocity.dot(&momentum) + body.armature_kgm2 * dq * dq
        });
        let energy = 0.5 * twice.sum::<f64>();
        check_result("the kinetic energy", &[energy])?;
        Ok(energy)
    }

    /// Potential energy in the field of gravity \[J\], 0 with all mass at the base's origin.
    ///
    /// # Errors
    ///
    /// [`DynamicsError::Length`], [`DynamicsError::NonFiniteJoint`], [`DynamicsError::Overflow`].
    pub fn potential_energy_j(
        &self,
        q: &[f64],
        scratch: &mut [Scratch],
    ) -> Result<f64, DynamicsError> {
        self.check_joints("position", q)?;
        self.check_scratch(scratch)?;
        self.place(q, scratch);
        self.weigh(scratch);
        let height = |own: &Scratch| self.gravity_mps2().dot(&own.inertia.first_moment_kgm);
        let energy = -scratch.iter().map(height).sum::<f64>();
        check_result("the potential energy", &[energy])?;
        Ok(energy)
    }
}
