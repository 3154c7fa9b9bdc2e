//! Known angles at which a homing fixture holds a joint's link.

use haptical_model::{Device, JointType, ModelError, Parameter, ParameterId, Recording};

use super::kind::{Measurement, Posture, is_known, reading};

/// Reading + transmission error + joint offset, against the angle from home that a fixture holds the link at:
/// the columns `fixture1_rad`, ... (`_m` for a prismatic joint). It fixes a joint's offset by itself. The joint's reading
/// enters as it is; [`crate::Weights`] adds its step.
pub(crate) struct Fixture {
    /// Joint, from 0.
    pub(crate) joint: usize,
}

/// The fixture's column of a joint: a further column of the log.
fn column(recording: &Recording, joint: usize) -> Option<&Vec<f64>> {
    let number = joint + 1;
    let is_own = |name: &str| {
        let rest = name.strip_prefix("fixture").and_then(|rest| {
            rest.strip_suffix("_rad")
                .or_else(|| rest.strip_suffix("_m"))
        });
        rest.is_some_and(|rest| rest == number.to_string())
    };
    let found = recording.covariates.iter().find(|(name, _)| is_own(name));
    found.map(|(_, column)| column)
}

impl Fixture {
    /// The joint offset of the first row that the joint moves.
    fn offset(&self, device: &Device) -> Option<ParameterId> {
        let row = device.first_row(self.joint)?;
        let parameter = match device.joints.get(self.joint)?.joint_type {
            JointType::Revolute => Parameter::Theta,
            JointType::Prismatic => Parameter::D,
        };
        (row < device.links.len()).then_some(ParameterId::Link { row, parameter })
    }
}

impl Measurement for Fixture {
    /// The weight, and the joint's offset.
    type Seen = (f64, Option<ParameterId>);

    fn unit(&self, device: &Device) -> &'static str {
        device.joints[self.joint].unit()
    }

    fn has_reading(&self, recording: &Recording, row: usize) -> bool {
        is_known(column(recording, self.joint), row)
    }

    fn stated_sd(&self, device: &Device) -> Option<f64> {
        device.surroundings.fixture_sd_rad
    }

    /// Its own transmission, and offsets: which of them is the joint's only the device tells.
    fn sees(&self, parameter: ParameterId) -> bool {
        match parameter {
            ParameterId::Transmission { joint, .. } => joint == self.joint,
            ParameterId::Link { parameter, .. } => {
                matches!(parameter, Parameter::Theta | Parameter::D)
            }
            ParameterId::Effect { .. } => true,
            _ => false,
        }
    }

    fn see(&self, at: &Posture<'_>, weight: f64) -> Result<([f64; 3], Self::Seen), ModelError> {
        let offset = self.offset(at.device);
        let angle = at.evaluation.output_rad(self.joint)
            + offset.map_or(0.0, |offset| offset.value(at.device));
        let held = reading(column(at.recording, self.joint), at.row);
        Ok(([weight * (angle - held), 0.0, 0.0], (weight, offset)))
    }

    fn derivative(
        &self,
        (weight, offset): &Self::Seen,
        at: &Posture<'_>,
        parameter: ParameterId,
    ) -> [f64; 3] {
        let slope = if *offset == Some(parameter) {
            1.0
        } else {
            at.evaluation.output_derivative(self.joint, parameter)
        };
        [weight * slope, 0.0, 0.0]
    }
}
