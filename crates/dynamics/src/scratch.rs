//! Holds what an evaluation knows of one body.

use haptical_kinematics::Pose;
use nalgebra::{Matrix3, Vector3};

use crate::Inertia;
use crate::articulated::Articulated;
use crate::spatial::{Force, Motion};

/// Room for the numbers of one body during an evaluation; a tree needs one for each body.
#[derive(Clone, Copy, Debug, Default)]
pub struct Scratch {
    pub(crate) pose: Pose,
    /// The twist of the body per unit of the joint's velocity, S.
    pub(crate) screw: Motion,
    pub(crate) velocity: Motion,
    /// The acceleration; the base's is minus gravity.
    pub(crate) acceleration: Motion,
    /// Of the body alone, or of all that it carries.
    pub(crate) inertia: Inertia,
    /// On the body alone, or on all that it carries.
    pub(crate) force: Force,
    /// How the screw changes, and its second change: derivatives only.
    pub(crate) screw_rates: [Motion; 2],
    /// Linear momentum: derivatives only.
    pub(crate) momentum: Vector3<f64>,
    /// How the moment depends on a change of turning: derivatives only.
    pub(crate) drift: Matrix3<f64>,
    /// Forward dynamics only.
    pub(crate) articulated: Articulated,
}

impl Scratch {
    /// The body's frame in the base's frame, at the `q` of the last evaluation that succeeded with this scratch.
    pub fn pose(&self) -> &Pose {
        &self.pose
    }
}
