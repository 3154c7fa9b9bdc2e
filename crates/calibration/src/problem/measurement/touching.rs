//! The point that touches: the handle, or a tool on it.

use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::kinematics::{Pose, Twist};
use haptical_model::{Device, ModelError, Mount, ParameterId, SurroundingParameter};

use super::kind::Posture;

/// The touching point in frame (-1), and the way to it from the handle.
///
/// With p the point in the handle frame and R the handle's orientation it is at P + R p (docs/equations.md, Touched
/// points).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Touching {
    pub(crate) position_m: Vector3<f64>,
    pub(crate) arm: Vector3<f64>,
    rotation: Matrix3<f64>,
    tool: Option<usize>,
}

impl Touching {
    pub(crate) fn new(at: &Posture<'_>) -> Result<Self, ModelError> {
        Ok(Self::of_handle(at.device, at.evaluation.pose()?, at.mount))
    }

    pub(crate) fn of_handle(device: &Device, handle: &Pose, mount: Mount) -> Self {
        let arm = handle.rotation * device.touching_m(mount);
        Self {
            position_m: handle.position_m + arm,
            arm,
            rotation: handle.rotation,
            tool: mount.tool.filter(|&tool| device.touches(tool)),
        }
    }

    /// How the point moves when the handle moves by a twist.
    pub(crate) fn carried(&self, twist: &Twist) -> Vector3<f64> {
        twist.linear + twist.angular.cross(&self.arm)
    }

    /// How the point moves with a number of its own tool; none for another parameter.
    pub(crate) fn own(&self, parameter: ParameterId) -> Option<Vector3<f64>> {
        match parameter {
            ParameterId::Surrounding(SurroundingParameter::Tool {
                tool,
                index: index @ 0..3,
            }) if Some(tool) == self.tool => Some(self.rotation.column(index).into_owned()),
            _ => None,
        }
    }
}
