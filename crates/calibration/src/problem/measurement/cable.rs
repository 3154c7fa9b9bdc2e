//! The distance that a cable encoder measures from its anchor to the handle.

use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::kinematics::{Twist, distance_derivative, distance_m};
use haptical_model::{CableReading, SurroundingParameter};
use haptical_model::{Device, ModelError, ParameterId, Recording};

use super::kind::{Measurement, Posture, is_known, is_of_chain, reading};

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
    weight: f64,
    read: Option<CableReading>,
}

impl Measurement for Cable {
    const WIDTH: usize = 1;
    type Seen = Seen;

    fn unit(&self, _: &Device) -> &'static str {
        "m"
    }

    fn has_reading(&self, recording: &Recording, row: usize) -> bool {
        is_known(
            recording.cable_m.get(self.index).and_then(Option::as_ref),
            row,
        )
    }

    fn stated_sd(&self, device: &Device) -> Option<f64> {
        device.cable_sd_m(self.index)
    }

    fn sees(&self, parameter: ParameterId) -> bool {
        if let ParameterId::Surrounding(
            SurroundingParameter::CableAnchor { cable, .. }
            | SurroundingParameter::CableZero { cable }
            | SurroundingParameter::CableScale { cable }
            | SurroundingParameter::CableExitRadius { cable },
        ) = parameter
        {
            return cable == self.index;
        }
        is_of_chain(parameter)
    }

    fn see(&self, at: &Posture<'_>, weight: f64) -> Result<([f64; 3], Seen), ModelError> {
        let cable = at.device.cables.get(self.index);
        let measured = reading(at.recording.cable_m[self.index].as_ref(), at.row);
        let pose = at.evaluation.pose()?;
        if let Some(cable) = cable.filter(|cable| !cable.is_plain()) {
            let read = cable.reading(&pose.position_m)?;
            let seen = Seen {
                by_position: read.by_position * weight,
                weight,
                read: Some(read),
            };
            return Ok(([weight * (read.reading_m - measured), 0.0, 0.0], seen));
        }
        let anchor = Vector3::from(cable.map_or([0.0; 3], |cable| cable.anchor_m));
        let distance = distance_m(&pose.position_m, &anchor)?;
        let seen = Seen {
            // docs/equations.md, "Distance derivative": the direction once for all parameters.
            by_position: (pose.position_m - anchor) * (weight / distance),
            weight,
            read: None,
        };
        Ok(([weight * (distance - measured), 0.0, 0.0], seen))
    }

    fn derivative(&self, seen: &Seen, at: &Posture<'_>, parameter: ParameterId) -> [f64; 3] {
        if let ParameterId::Surrounding(parameter) = parameter {
            let length_m = seen.read.map_or(0.0, |read| read.length_m);
            let by_radius = seen.read.map_or(0.0, |read| read.by_exit_radius);
            let own = match parameter {
                SurroundingParameter::CableAnchor { cable, axis } if cable == self.index => {
                    -seen.by_position[axis]
                }
                SurroundingParameter::CableZero { cable } if cable == self.index => seen.weight,
                SurroundingParameter::CableScale { cable } if cable == self.index => {
                    seen.weight * length_m
                }
                SurroundingParameter::CableExitRadius { cable } if cable == self.index => {
                    seen.weight * by_radius
                }
                _ => 0.0,
            };
            return [own, 0.0, 0.0];
        }
        let along = seen
            .by_position
            .dot(&at.evaluation.pose_derivative(parameter).linear);
        [along, 0.0, 0.0]
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
