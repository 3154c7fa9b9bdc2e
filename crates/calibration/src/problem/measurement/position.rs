//! The position that a tracker sees.

use haptical_model::kinematics::Twist;
use haptical_model::{Device, ModelError, ParameterId, Recording, SurroundingParameter};

use super::kind::{Measurement, Posture};
use super::sight::{Sight, arm};
use super::tracked::is_of_tracker;

/// The handle's position in frame (-1), or that of what is tracked in the tracker's frame.
pub(crate) struct Position;

impl Measurement for Position {
    const WIDTH: usize = 3;
    const IS_OF_HANDLE: bool = true;
    /// The weight, and what the tracker sees.
    type Seen = (f64, Sight);

    fn has_reading(&self, recording: &Recording, row: usize) -> bool {
        let axes = recording.position_m.as_ref();
        axes.is_some_and(|axes| axes.iter().all(|axis| axis[row].is_finite()))
    }

    fn stated_sd(&self, device: &Device) -> Option<f64> {
        device.tracker.and_then(|tracker| tracker.position_sd_m)
    }

    fn owns(&self, parameter: SurroundingParameter) -> bool {
        is_of_tracker(parameter)
    }

    fn see(&self, at: &Posture<'_>, weight: f64) -> Result<([f64; 3], Self::Seen), ModelError> {
        let sight = Sight::new(at)?;
        let mut residuals = [0.0; 3];
        if let Some(axes) = &at.recording.position_m {
            for axis in 0..3 {
                residuals[axis] = weight * (sight.pose().position_m[axis] - axes[axis][at.row]);
            }
        }
        Ok((residuals, (weight, sight)))
    }

    fn derivative(
        &self,
        (weight, sight): &Self::Seen,
        at: &Posture<'_>,
        parameter: ParameterId,
    ) -> [f64; 3] {
        (sight.derivative(at, parameter).linear * *weight).into()
    }

    fn by_twist(&self, (weight, sight): &Self::Seen, twist: &Twist) -> [f64; 3] {
        (sight.carried(twist).linear * *weight).into()
    }

    fn sensitivity_square(&self, at: &Posture<'_>, twist: &Twist) -> Result<f64, ModelError> {
        // a turn into the tracker's frame changes no length
        let linear = twist.linear + twist.angular.cross(&arm(at)?);
        Ok(linear.norm_squared() / 3.0)
    }
}
