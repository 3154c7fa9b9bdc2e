//! The position that a tracker sees.

use haptical_model::kinematics::Twist;
use haptical_model::{Device, ModelError, ParameterId, Recording};

use super::kind::{Measurement, Posture, is_of_chain};
use super::tracked::{Tracked, is_of_tracker};

/// The handle's position in frame (-1), or that of what is tracked in the tracker's frame.
pub(crate) struct Position;

/// The weight, and the tracker's frames where they are not those of the chain.
pub(crate) struct Seen {
    weight: f64,
    tracked: Option<Tracked>,
}

impl Measurement for Position {
    const WIDTH: usize = 3;
    type Seen = Seen;

    fn unit(&self, _: &Device) -> &'static str {
        "m"
    }

    fn has_reading(&self, recording: &Recording, row: usize) -> bool {
        let axes = recording.position_m.as_ref();
        axes.is_some_and(|axes| axes.iter().all(|axis| axis[row].is_finite()))
    }

    fn stated_sd(&self, device: &Device) -> Option<f64> {
        device.tracker.and_then(|tracker| tracker.position_sd_m)
    }

    fn sees(&self, parameter: ParameterId) -> bool {
        if is_of_tracker(parameter) {
            return true;
        }
        is_of_chain(parameter)
    }

    fn see(&self, at: &Posture<'_>, weight: f64) -> Result<([f64; 3], Seen), ModelError> {
        let pose = at.evaluation.pose()?;
        let predicted_m = pose.position_m;
        let tracked = Tracked::new(at.device, pose);
        let predicted_m = tracked.map_or(predicted_m, |tracked| tracked.pose().position_m);
        let mut residuals = [0.0; 3];
        if let Some(axes) = &at.recording.position_m {
            for axis in 0..3 {
                residuals[axis] = weight * (predicted_m[axis] - axes[axis][at.row]);
            }
        }
        let seen = Seen { weight, tracked };
        Ok((residuals, seen))
    }

    fn derivative(&self, seen: &Seen, at: &Posture<'_>, parameter: ParameterId) -> [f64; 3] {
        let weight = seen.weight;
        if let Some(tracked) = &seen.tracked {
            let own = tracked.derivative(parameter);
            let twist =
                own.unwrap_or_else(|| tracked.carried(&at.evaluation.pose_derivative(parameter)));
            return (twist.linear * weight).into();
        }
        (at.evaluation.pose_derivative(parameter).linear * weight).into()
    }

    fn sensitivity_square(&self, at: &Posture<'_>, twist: &Twist) -> Result<f64, ModelError> {
        if let Some(tracked) = Tracked::new(at.device, at.evaluation.pose()?) {
            return Ok(tracked.carried(twist).linear.norm_squared() / 3.0);
        }
        Ok(twist.linear.norm_squared() / 3.0)
    }
}
