//! The orientation that a tracker sees.

use haptical_model::kinematics::Twist;
use haptical_model::kinematics::nalgebra::Matrix3;
use haptical_model::{Device, ModelError, ParameterId, Recording, SurroundingParameter};

use super::kind::{Measurement, Posture};
use super::sight::Sight;
use super::tracked::is_of_tracker;
use crate::problem::measurement::rotation::{
    inverse_left_jacobian, measured_rotation, rotation_vector,
};

/// Rotation vector from the measured to the handle's orientation in frame (-1), or to that of what is tracked
/// in the tracker's frame.
pub(crate) struct Orientation;

/// The derivative of the rotation vector by a turn, the weight, and what the tracker sees.
pub(crate) struct Seen {
    inverse: Matrix3<f64>,
    weight: f64,
    sight: Sight,
}

impl Measurement for Orientation {
    const WIDTH: usize = 3;
    const IS_OF_HANDLE: bool = true;
    type Seen = Seen;

    fn unit(&self, _: &Device) -> &'static str {
        "rad"
    }

    fn has_reading(&self, recording: &Recording, row: usize) -> bool {
        let parts = recording.orientation_wxyz.as_ref();
        parts.is_some_and(|parts| parts.iter().all(|part| part[row].is_finite()))
    }

    fn stated_sd(&self, device: &Device) -> Option<f64> {
        device.tracker.and_then(|tracker| tracker.rotation_sd_rad)
    }

    fn owns(&self, parameter: SurroundingParameter) -> bool {
        is_of_tracker(parameter)
    }

    fn see(&self, at: &Posture<'_>, weight: f64) -> Result<([f64; 3], Seen), ModelError> {
        let measured = measured_rotation(at.recording, at.row);
        let sight = Sight::new(at)?;
        let rest = rotation_vector(&(sight.pose().rotation * measured.transpose()));
        let seen = Seen {
            inverse: inverse_left_jacobian(&rest),
            weight,
            sight,
        };
        Ok(([weight * rest[0], weight * rest[1], weight * rest[2]], seen))
    }

    fn derivative(&self, seen: &Seen, at: &Posture<'_>, parameter: ParameterId) -> [f64; 3] {
        let angular = seen.sight.derivative(at, parameter).angular;
        (seen.inverse * angular * seen.weight).into()
    }

    fn by_twist(&self, seen: &Seen, twist: &Twist) -> [f64; 3] {
        (seen.inverse * seen.sight.carried(twist).angular * seen.weight).into()
    }

    fn sensitivity_square(&self, _: &Posture<'_>, twist: &Twist) -> Result<f64, ModelError> {
        Ok(twist.angular.norm_squared() / 3.0)
    }
}
