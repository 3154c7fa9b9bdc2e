//! What rows of a recording ask of a posture.

use haptical_model::{AddedReadings, Device, JointType, Mount, Parameter, ParameterId, Recording};

use crate::SimulatorError;

/// Angles at which a fixture holds a joint's link.
#[derive(Debug, Clone)]
pub(super) struct Held {
    pub(super) joint: usize,
    /// Row by row; NaN where it does not.
    pub(super) angle: Vec<f64>,
    pub(super) noise: Vec<f64>,
}

/// The offset of a joint's first row, which a fixture sees with its angle.
pub(super) fn offset(device: &Device, joint: usize) -> f64 {
    let row = device
        .first_row(joint)
        .filter(|row| *row < device.links.len());
    let parameter = match device.joints[joint].joint_type {
        JointType::Revolute => Parameter::Theta,
        JointType::Prismatic => Parameter::D,
    };
    row.map_or(0.0, |row| {
        ParameterId::Link { row, parameter }.value(device)
    })
}

/// The angles from home that a fixture holds a joint's link at.
pub(super) fn fixture(asked: &Recording, joint: usize) -> Option<&Vec<f64>> {
    let names = ["rad", "m"].map(|unit| format!("fixture{}_{unit}", joint + 1));
    let column = asked
        .covariates
        .iter()
        .find(|(name, _)| names.contains(name));
    column.map(|(_, column)| column)
}

/// What effects show of a row in an axis of a channel.
pub(super) fn sum_of(shown: &[AddedReadings], channel: &str, axis: usize, row: usize) -> f64 {
    let own = shown
        .iter()
        .filter(|own| own.channel == channel && own.axis == axis);
    own.filter_map(|own| own.readings.get(row)).sum()
}

/// What each row is about, of a device in which all of it has a place.
pub(super) fn mounts(device: &Device, asked: &Recording) -> Result<Vec<Mount>, SimulatorError> {
    device
        .mounts(asked)
        .map_err(|unplaced| SimulatorError::NoPosture {
            what: format!(
                "row {}: `{}` of the column {} has no place",
                unplaced.row, unplaced.id, unplaced.column
            ),
        })
}
