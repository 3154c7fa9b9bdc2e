//! A recording's torques as they were read, and without what the device's effects add to them.

use haptical_model::{Device, Recording};

/// A joint's recorded torque without what the device's effects add to it ([`Recording::added`]); none where it was not recorded. A
/// column that has one value throughout stays as it is: nothing was measured there that an effect could have added to.
#[must_use]
pub fn torque_nm_without_effects(
    device: &Device,
    recording: &Recording,
    joint: usize,
) -> Option<Vec<f64>> {
    let mut torque_nm = recording.torque_nm.get(joint)?.clone()?;
    let mut values = torque_nm.iter().filter(|value| value.is_finite());
    let first = values.next();
    if values.all(|value| Some(value) == first) {
        return Some(torque_nm);
    }
    let column = device.joints[joint].torque_column(joint + 1);
    for own in recording.added.iter().filter(|own| own.channel == column) {
        for (torque, added) in torque_nm.iter_mut().zip(&own.readings) {
            *torque -= added;
        }
    }
    Some(torque_nm)
}

/// The recording with torques that the bare device would have.
pub(crate) fn without_effects(device: &Device, recording: &Recording) -> Recording {
    let joints = 0..recording.torque_nm.len();
    Recording {
        torque_nm: joints
            .map(|joint| torque_nm_without_effects(device, recording, joint))
            .collect(),
        ..recording.clone()
    }
}

/// A log and a second one, as they were read and without what the device's effects add to their torques.
pub(crate) struct Logs<'l> {
    /// The log as it was read.
    pub(crate) read: &'l Recording,
    pub(crate) log: Recording,
    pub(crate) second: Option<Recording>,
}

impl<'l> Logs<'l> {
    pub(crate) fn new(device: &Device, read: &'l Recording, second: Option<&Recording>) -> Self {
        Self {
            read,
            log: without_effects(device, read),
            second: second.map(|second| without_effects(device, second)),
        }
    }
}
