//! What a tracker sees at a row, and how it changes.

use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::kinematics::{Pose, Twist};
use haptical_model::{ModelError, ParameterId, SurroundingParameter};

use super::kind::Posture;
use super::tracked::Tracked;

/// What a tracker sees of the device at a row: the handle itself, or what is tracked.
pub(crate) struct Sight(Tracked);

/// From the handle to what the tracker sees, in frame (-1).
pub(crate) fn arm(at: &Posture<'_>) -> Result<Vector3<f64>, ModelError> {
    let handle = at.evaluation.pose()?;
    let mounting = at.mountings.of(at.mount);
    Ok(mounting.map_or_else(Vector3::zeros, |own| own.arm(handle)))
}

impl Sight {
    pub(crate) fn new(at: &Posture<'_>) -> Result<Self, ModelError> {
        let handle = at.evaluation.pose()?;
        let mounting = at.mountings.of(at.mount);
        Ok(Self(mounting.map_or_else(
            || Tracked::itself(handle),
            |own| own.at(handle),
        )))
    }

    pub(crate) fn pose(&self) -> Pose {
        self.0.pose()
    }

    /// How it changes when the handle moves by a twist in frame (-1).
    pub(crate) fn carried(&self, twist: &Twist) -> Twist {
        self.0.carried(twist)
    }

    /// How the pose changes with a parameter of the chain or the tracker.
    pub(crate) fn derivative(&self, at: &Posture<'_>, parameter: ParameterId) -> Twist {
        if parameter == ParameterId::Surrounding(SurroundingParameter::TrackerScale) {
            return Twist {
                linear: self.0.pose().position_m,
                angular: Vector3::zeros(),
            };
        }
        let mounting = at.mountings.of(at.mount);
        let own = mounting.and_then(|own| self.0.derivative(own, parameter));
        own.unwrap_or_else(|| self.carried(&at.evaluation.pose_derivative(parameter)))
    }
}
