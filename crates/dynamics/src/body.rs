//! Holds what a tree is made of: bodies, each behind one joint.

use haptical_kinematics::Pose;
use nalgebra::{Unit, Vector3};

use crate::Inertia;

/// How a body moves on its parent, and along which axis of the joint's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Joint {
    /// The joint variable \[rad\] turns the body about the axis.
    Revolute(Unit<Vector3<f64>>),
    /// The joint variable \[m\] slides the body along the axis.
    Prismatic(Unit<Vector3<f64>>),
}

impl Joint {
    /// The axis, in the joint's frame.
    pub const fn axis(&self) -> &Unit<Vector3<f64>> {
        match self {
            Self::Revolute(axis) | Self::Prismatic(axis) => axis,
        }
    }
}

/// A rigid body and the joint that carries it.
///
/// The body's frame is the joint's frame behind the joint's motion: with every joint variable 0 it is at
/// `placement` in the parent's frame. What is fixed to a body is part of it:
/// [`Inertia::seen_from`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// The body that it hangs on, which comes before it; none for the base, which stands still.
    pub parent: Option<usize>,
    /// The joint's frame in the parent's frame.
    pub placement: Pose,
    /// What the joint does.
    pub joint: Joint,
    /// Its inertia, in its own frame.
    pub inertia: Inertia,
    /// What the motor's rotor and the gear add to the joint's inertia, seen at the joint \[kg m^2\] (of a
    /// prismatic joint \[kg\]): the rotor's inertia times the square of the gear's ratio. Their
    /// gyroscopic torques are left out (Featherstone 2008, section 9.6).
    pub armature_kgm2: f64,
}

/// A force and a moment with which the surroundings act on a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrench {
    /// Body on which it acts, counted from 0.
    pub body: usize,
    /// Where the force acts, in the body's frame \[m\].
    pub point_m: Vector3<f64>,
    /// The force, along the base's axes \[N\].
    pub force_n: Vector3<f64>,
    /// The moment about that point, along the base's axes \[Nm\].
    pub moment_nm: Vector3<f64>,
}
