//! Equations of motion of a device's joints, from those of its rows.

use haptical_dynamics::{DynamicsError, TorqueDerivatives, Tree};

use crate::cholesky::{factor, solve};
use crate::{ModelError, MotionWork, RigidBodies};

/// Inertial parameters of a body.
const PARAMETERS: usize = 10;

impl RigidBodies {
    /// Room for one evaluation.
    pub fn work(&self) -> MotionWork {
        MotionWork::new(self.bodies().len(), self.joint_count())
    }

    /// Torques of a motion, armatures included; one of each for every joint.
    ///
    /// Source: [`Tree::inverse_dynamics`].
    ///
    /// # Errors
    /// [`ModelError::JointCount`]; [`ModelError::Dynamics`] for numbers that are not finite and slices of a wrong length.
    pub fn torques(
        &self,
        theta: &[f64],
        dtheta: &[f64],
        ddtheta: &[f64],
        work: &mut MotionWork,
        tau: &mut [f64],
    ) -> Result<(), ModelError> {
        let tree = self.placed(work, [Some(theta), Some(dtheta), Some(ddtheta)])?;
        self.check("the slice of torques", tau, self.joint_count())?;
        let rows = (&mut work.scratch, &mut work.tau);
        tree.inverse_dynamics(&work.q, &work.dq, &work.ddq, &[], rows.0, rows.1)?;
        self.collect(&work.tau, tau);
        Ok(())
    }

    /// Torques of a motion without acceleration, `b(theta, dtheta)`: gravity, Coriolis and centrifugal torques.
    ///
    /// # Errors
    /// As [`RigidBodies::torques`].
    pub fn bias(
        &self,
        theta: &[f64],
        dtheta: &[f64],
        work: &mut MotionWork,
        tau: &mut [f64],
    ) -> Result<(), ModelError> {
        let tree = self.placed(work, [Some(theta), Some(dtheta), None])?;
        self.check("the slice of torques", tau, self.joint_count())?;
        tree.bias_forces(&work.q, &work.dq, &mut work.scratch, &mut work.tau)?;
        self.collect(&work.tau, tau);
        Ok(())
    }

    /// How the torques depend on the ten inertial parameters of each body ([`haptical_dynamics::Inertia::parameters`]), row
    /// by row: joints x 10 bodies entries. Armatures are not among them: the column of a joint's is its acceleration.
    ///
    /// Source: [`Tree::regressor`].
    ///
    /// # Errors
    /// As [`RigidBodies::torques`].
    pub fn regressor(
        &self,
        theta: &[f64],
        dtheta: &[f64],
        ddtheta: &[f64],
        work: &mut MotionWork,
        out: &mut [f64],
    ) -> Result<(), ModelError> {
        let tree = self.placed(work, [Some(theta), Some(dtheta), Some(ddtheta)])?;
        let columns = PARAMETERS * self.bodies().len();
        self.check("the regressor", out, self.joint_count() * columns)?;
        let (q, dq, ddq) = (&work.q, &work.dq, &work.ddq);
        if self.is_plain {
            return Ok(tree.regressor(q, dq, ddq, &mut work.scratch, out)?);
        }
        tree.regressor(q, dq, ddq, &mut work.scratch, &mut work.regressor)?;
        out.fill(0.0);
        for (row, (joint, multiplier)) in work.regressor.chunks(columns).zip(&self.drives) {
            let own = &mut out[joint * columns..][..columns];
            own.iter_mut()
                .zip(row)
                .for_each(|(own, entry)| *own += multiplier * entry);
        }
        Ok(())
    }

    /// Derivatives of [`RigidBodies::torques`] by positions and by velocities, row by row: joints x joints entries, that of
    /// torque i by joint j at `i n + j`. The one by accelerations is [`RigidBodies::mass_matrix`].
    ///
    /// Source: [`Tree::torque_derivatives`].
    ///
    /// # Errors
    /// As [`RigidBodies::torques`].
    pub fn derivatives(
        &self,
        theta: &[f64],
        dtheta: &[f64],
        ddtheta: &[f64],
        work: &mut MotionWork,
        out: TorqueDerivatives<'_>,
    ) -> Result<(), ModelError> {
        let tree = self.placed(work, [Some(theta), Some(dtheta), Some(ddtheta)])?;
        let TorqueDerivatives {
            by_q: by_theta,
            by_dq: by_dtheta,
        } = out;
        let count = self.joint_count() * self.joint_count();
        self.check("the derivative by positions", by_theta, count)?;
        self.check("the derivative by velocities", by_dtheta, count)?;
        let [by_q, by_dq] = &mut work.matrices;
        let rows = TorqueDerivatives { by_q, by_dq };
        tree.torque_derivatives(&work.q, &work.dq, &work.ddq, &mut work.scratch, rows)?;
        self.collect_matrix(&work.matrices[0], by_theta);
        self.collect_matrix(&work.matrices[1], by_dtheta);
        Ok(())
    }

    /// The mass matrix, armatures on its diagonal, row by row: joints x joints entries.
    ///
    /// # Errors
    /// As [`RigidBodies::torques`].
    pub fn mass_matrix(
        &self,
        theta: &[f64],
        work: &mut MotionWork,
        out: &mut [f64],
    ) -> Result<(), ModelError> {
        let tree = self.placed(work, [Some(theta), None, None])?;
        let count = self.joint_count() * self.joint_count();
        self.check("the mass matrix", out, count)?;
        tree.mass_matrix(&work.q, &mut work.scratch, &mut work.matrices[0])?;
        self.collect_matrix(&work.matrices[0], out);
        Ok(())
    }

    /// Accelerations that torques of the drives make; one for each joint.
    ///
    /// Without rows that follow a joint by [`Tree::forward_dynamics`]; with such rows from `M ddtheta = tau - b`.
    ///
    /// # Errors
    /// As [`RigidBodies::torques`]; [`DynamicsError::NoInertia`] for a joint that moves nothing with inertia.
    pub fn forward(
        &self,
        theta: &[f64],
        dtheta: &[f64],
        tau: &[f64],
        work: &mut MotionWork,
        out: &mut [f64],
    ) -> Result<(), ModelError> {
        self.count(tau)?;
        self.check("the slice of accelerations", out, self.joint_count())?;
        if self.is_plain {
            let tree = self.placed(work, [Some(theta), Some(dtheta), None])?;
            let (q, dq) = (&work.q, &work.dq);
            return Ok(tree.forward_dynamics(q, dq, tau, &[], &mut work.scratch, out)?);
        }
        let mut matrix = std::mem::take(&mut work.joint_matrix);
        let mut bias = std::mem::take(&mut work.joint_vector);
        let evaluated = self
            .mass_matrix(theta, work, &mut matrix)
            .and_then(|()| self.bias(theta, dtheta, work, &mut bias));
        let solved = evaluated.and_then(|()| {
            for ((out, tau), bias) in out.iter_mut().zip(tau).zip(&bias) {
                *out = tau - bias;
            }
            factor(&mut matrix, out.len())?;
            solve(&matrix, out);
            Ok(())
        });
        work.joint_matrix = matrix;
        work.joint_vector = bias;
        solved
    }

    /// Takes the joints' numbers to the rows; what is none is 0.
    fn placed(
        &self,
        work: &mut MotionWork,
        [theta, dtheta, ddtheta]: [Option<&[f64]>; 3],
    ) -> Result<Tree<'_>, ModelError> {
        let rows = [
            (theta, &mut work.q),
            (dtheta, &mut work.dq),
            (ddtheta, &mut work.ddq),
        ];
        for (joints, rows) in rows {
            self.check("the work", rows, self.bodies().len())?;
            let Some(joints) = joints else {
                rows.fill(0.0);
                continue;
            };
            self.count(joints)?;
            for (row, (joint, multiplier)) in rows.iter_mut().zip(&self.drives) {
                *row = multiplier * joints[*joint];
            }
        }
        self.tree()
    }

    fn collect(&self, rows: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for (row, (joint, multiplier)) in rows.iter().zip(&self.drives) {
            out[*joint] += multiplier * row;
        }
    }

    fn collect_matrix(&self, rows: &[f64], out: &mut [f64]) {
        let (count, joints) = (self.bodies().len(), self.joint_count());
        out.fill(0.0);
        for (row, (i, by_i)) in rows.chunks(count).zip(&self.drives) {
            for (entry, (j, by_j)) in row.iter().zip(&self.drives) {
                out[i * joints + j] += by_i * by_j * entry;
            }
        }
    }

    fn count(&self, numbers: &[f64]) -> Result<(), ModelError> {
        let (expected, found) = (self.joint_count(), numbers.len());
        match found == expected {
            true => Ok(()),
            false => Err(ModelError::JointCount { expected, found }),
        }
    }

    fn check(
        &self,
        buffer: &'static str,
        numbers: &[f64],
        expected: usize,
    ) -> Result<(), ModelError> {
        let got = numbers.len();
        match got == expected {
            true => Ok(()),
            false => Err(DynamicsError::Length {
                buffer,
                expected,
                got,
            }
            .into()),
        }
    }
}
