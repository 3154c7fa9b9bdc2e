//! The distance that a cable encoder measures from its anchor to the handle.

use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::kinematics::{Twist, distance_derivative, distance_m};
use haptical_model::{Device, ModelError, ParameterId, Recording, SurroundingParameter};

use super::kind::{Measurement, Posture, is_known, reading};

/// Baser & Konukseven eq. (5), with zero, scale and guide where the cable has them
/// ([`haptical_model::Cable::reading`]).
pub(crate) struct Cable {
    /// Cable, from 0.
    pub(crate) index: usize,
}

/// What is known of the cable at a row, times the weight.
pub(crate) struct Seen {
    /// Derivative by the handle's position.
    by_position: Vector3<f64>,
    /// By the scale: the length without zero.
    by_scale: f64,
    by_exit_radius: f64,
    /// By the zero.
    weight: f64,
}

impl Measurement for Cable {
    const IS_OF_HANDLE: bool = true;
    type Seen = Seen;

    fn has_reading(&self, recording: &Recording, row: usize) -> bool {
        is_known(
            recording.cable_m.get(self.index).and_then(Option::as_ref),
            row,
        )
    }

    fn stated_sd(&self, device: &Device) -> Option<f64> {
        device.cable_sd_m(self.index)
    }

    fn owns(&self, parameter: SurroundingParameter) -> bool {
        use SurroundingParameter::{CableAnchor, CableExitRadius, CableScale, CableZero};
        match parameter {
            CableAnchor { cable, .. }
            | CableZero { cable }
            | CableScale { cable }
            | CableExitRadius { cable } => cable == self.index,
            _ => false,
        }
    }

    fn see(&self, at: &Posture<'_>, weight: f64) -> Result<([f64; 3], Seen), ModelError> {
        let cable = at.device.cables.get(self.index);
        let measured = reading(at.recording.cable_m[self.index].as_ref(), at.row);
        let position_m = at.evaluation.pose()?.position_m;
        let (predicted, seen) = if let Some(cable) = cable.filter(|cable| !cable.is_plain()) {
            let read = cable.reading(&position_m)?;
            let seen = Seen {
                by_position: read.by_position * weight,
                by_scale: weight * read.length_m,
                by_exit_radius: weight * read.by_exit_radius,
                weight,
            };
            (read.reading_m, seen)
        } else {
            let anchor = Vector3::from(cable.map_or([0.0; 3], |cable| cable.anchor_m));
            let distance = distance_m(&position_m, &anchor)?;
            let seen = Seen {
                // docs/equations.md, "Distance derivative": the direction once for all parameters.
                by_position: (position_m - anchor) * (weight / distance),
                by_scale: weight * distance,
                by_exit_radius: 0.0,
                weight,
            };
            (distance, seen)
        };
        Ok(([weight * (predicted - measured), 0.0, 0.0], seen))
    }

    fn derivative(&self, seen: &Seen, at: &Posture<'_>, parameter: ParameterId) -> [f64; 3] {
        use SurroundingParameter::{CableAnchor, CableExitRadius, CableScale};
        let slope = match parameter {
            ParameterId::Surrounding(CableAnchor { axis, .. }) => -seen.by_position[axis],
            ParameterId::Surrounding(CableScale { .. }) => seen.by_scale,
            ParameterId::Surrounding(CableExitRadius { .. }) => seen.by_exit_radius,
            ParameterId::Surrounding(_) => seen.weight,
            _ => return self.by_twist(seen, &at.evaluation.pose_derivative(parameter)),
        };
        [slope, 0.0, 0.0]
    }

    fn by_twist(&self, seen: &Seen, twist: &Twist) -> [f64; 3] {
        [seen.by_position.dot(&twist.linear), 0.0, 0.0]
    }

    fn sensitivity_square(&self, at: &Posture<'_>, twist: &Twist) -> Result<f64, ModelError> {
        let pose = at.evaluation.pose()?;
        let cable = at.device.cables.get(self.index);
        if let Some(cable) = cable.filter(|cable| !cable.is_plain()) {
            let by_position = cable.reading(&pose.position_m)?.by_position;
            return Ok(by_position.dot(&twist.linear).powi(2));
        }
        let anchor = cable.map_or([0.0; 3], |cable| cable.anchor_m);
        Ok(distance_derivative(pose, &Vector3::from(anchor), twist)?.powi(2))
    }
}
