//! Spatial vectors about the base's origin, along the base's axes.
//!
//! Featherstone, *Rigid Body Dynamics Algorithms* (2008), chapter 2, with the linear part first.

use nalgebra::Vector3;

/// A velocity or an acceleration: of the body's point at the base's origin, and of its turning.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Motion {
    pub(crate) linear: Vector3<f64>,
    pub(crate) angular: Vector3<f64>,
}

/// A force, or a momentum, with its moment about the base's origin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Force {
    pub(crate) force: Vector3<f64>,
    pub(crate) moment: Vector3<f64>,
}

impl Motion {
    pub(crate) fn plus(&self, other: &Self) -> Self {
        Self {
            linear: self.linear + other.linear,
            angular: self.angular + other.angular,
        }
    }

    /// `self + factor other`.
    pub(crate) fn plus_scaled(&self, factor: f64, other: &Self) -> Self {
        Self {
            linear: self.linear + other.linear * factor,
            angular: self.angular + other.angular * factor,
        }
    }

    /// `self x other`, the change of a motion vector that is carried along: Featherstone eq. (2.31).
    pub(crate) fn cross(&self, other: &Self) -> Self {
        Self {
            linear: self.angular.cross(&other.linear) + self.linear.cross(&other.angular),
            angular: self.angular.cross(&other.angular),
        }
    }

    /// `self x* other`, the change of a force vector that is carried along: Featherstone eq. (2.32).
    pub(crate) fn cross_force(&self, other: &Force) -> Force {
        Force {
            force: self.angular.cross(&other.force),
            moment: self.angular.cross(&other.moment) + self.linear.cross(&other.force),
        }
    }

    /// The power of a force at this velocity.
    pub(crate) fn dot(&self, other: &Force) -> f64 {
        self.linear.dot(&other.force) + self.angular.dot(&other.moment)
    }
}

impl Force {
    pub(crate) fn plus(&self, other: &Self) -> Self {
        self.plus_scaled(1.0, other)
    }

    /// `self + factor other`.
    pub(crate) fn plus_scaled(&self, factor: f64, other: &Self) -> Self {
        Self {
            force: self.force + other.force * factor,
            moment: self.moment + other.moment * factor,
        }
    }
}
