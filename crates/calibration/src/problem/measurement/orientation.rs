//! The orientation that a tracker sees.

use haptical_model::kinematics::Twist;
use haptical_model::kinematics::nalgebra::Matrix3;
use haptical_model::{Device, ModelError, ParameterId, Recording};

use super::kind::{Measurement, Posture, is_of_chain};
use super::tracked::{Tracked, is_of_tracker};
use crate::problem::measurement::rotation::{
    inverse_left_jacobian, measured_rotation, rotation_vector,
};

/// Rotation vector from the measured to the handle's orientation in frame (-1), or to that of what is tracked
/// in the tracker's frame.
pub(crate) struct Orientation;

/// The derivative of the rotation vector by a turn, and the weight.
pub(crate) struct Seen {
    inverse: Matrix3<f64>,
    weight: f64,
    tracked: Option<Tracked>,
}

impl Measurement for Orientation {
    const WIDTH: usize = 3;
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

    fn sees(&self, parameter: ParameterId) -> bool {
        if is_of_tracker(parameter) {
            return true;
        }
        is_of_chain(parameter)
    }

    fn see(&self, at: &Posture<'_>, weight: f64) -> Result<([f64; 3], Seen), ModelError> {
        let measured = measured_rotation(at.recording, at.row);
        let pose = at.evaluation.pose()?;
        let predicted = pose.rotation;
        let tracked = Tracked::new(at.device, pose);
        let predicted = tracked.map_or(predicted, |tracked| tracked.pose().rotation);
        let rest = rotation_vector(&(predicted * measured.transpose()));
        let seen = Seen {
            inverse: inverse_left_jacobian(&rest),
            weight,
            tracked,
        };
        Ok(([weight * rest[0], weight * rest[1], weight * rest[2]], seen))
    }

    fn derivative(&self, seen: &Seen, at: &Posture<'_>, parameter: ParameterId) -> [f64; 3] {
        let weight = seen.weight;
        if let Some(tracked) = &seen.tracked {
            let own = tracked.derivative(parameter);
            let twist =
                own.unwrap_or_else(|| tracked.carried(&at.evaluation.pose_derivative(parameter)));
            return (seen.inverse * twist.angular * weight).into();
        }
        let Twist { angular, .. } = at.evaluation.pose_derivative(parameter);
        (seen.inverse * angular * weight).into()
    }

    fn sensitivity_square(&self, _: &Posture<'_>, twist: &Twist) -> Result<f64, ModelError> {
        Ok(twist.angular.norm_squared() / 3.0)
    }
}
