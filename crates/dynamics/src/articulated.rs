//! The inertia of a body whose children give way.

use nalgebra::Matrix3;

use crate::Inertia;
use crate::spatial::{Force, Motion};

/// The inertia of a body that carries others by joints that are free: force = `[mass, cross^T; cross, moment]`
/// times acceleration.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Articulated {
    mass: Matrix3<f64>,
    cross: Matrix3<f64>,
    moment: Matrix3<f64>,
    /// The force at the acceleration 0.
    pub(crate) bias: Force,
    /// The force per acceleration of the joint.
    pub(crate) column: Force,
    /// Inertia about the joint's axis.
    pub(crate) pivot: f64,
    /// What is left of the joint's torque.
    pub(crate) torque: f64,
}

impl Articulated {
    pub(crate) fn new(inertia: &Inertia, bias: Force) -> Self {
        Self {
            mass: Matrix3::from_diagonal_element(inertia.mass_kg),
            cross: inertia.first_moment_kgm.cross_matrix(),
            moment: inertia.about_origin_kgm2,
            bias,
            ..Self::default()
        }
    }

    pub(crate) fn times(&self, motion: &Motion) -> Force {
        Force {
            force: self.mass * motion.linear + self.cross.tr_mul(&motion.angular),
            moment: self.cross * motion.linear + self.moment * motion.angular,
        }
    }

    /// The size of what cancels in the power of [`Articulated::times`] of a screw.
    pub(crate) fn size(&self, screw: &Motion) -> f64 {
        // the matrix is not negative: what is beside its diagonal is no larger than the diagonal
        self.mass.trace() * screw.linear.norm_squared()
            + self.moment.trace() * screw.angular.norm_squared()
    }

    /// What the parent feels of it: without what the joint gives way to.
    pub(crate) fn behind_joint(&self, change: &Motion) -> Self {
        let Force { force, moment } = self.column;
        let scaled = force.transpose() / self.pivot;
        let own = Self {
            mass: self.mass - force * scaled,
            cross: self.cross - moment * scaled,
            moment: self.moment - moment * moment.transpose() / self.pivot,
            ..*self
        };
        let bias = self.bias.plus(&own.times(change));
        Self {
            bias: bias.plus_scaled(self.torque / self.pivot, &self.column),
            ..own
        }
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.mass += other.mass;
        self.cross += other.cross;
        self.moment += other.moment;
        self.bias = self.bias.plus(&other.bias);
    }
}
