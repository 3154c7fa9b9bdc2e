//! A recording's torques as they were read, and without what the device's effects add to them.

use haptical_model::{Device, Recording, Statics};
use nalgebra::Vector3;

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

/// The recording with torques that the bare device would have with nothing at its handle.
pub(crate) fn without_effects(device: &Device, recording: &Recording) -> Recording {
    let joints = 0..recording.torque_nm.len();
    let torque_nm = joints.map(|joint| torque_nm_without_effects(device, recording, joint));
    let mut bare = Recording {
        torque_nm: torque_nm.collect(),
        ..recording.clone()
    };
    take_off_hand(device, &mut bare);
    bare
}

/// Takes the torques that hold the force of the hand off those of the drives: the principle of virtual work at each row (Craig 2018,
/// section 5.10). A row without a reading of the force, or at which the device has no value, has no torque.
fn take_off_hand(device: &Device, recording: &mut Recording) {
    let Some(axes) = recording.force_n.take() else {
        return;
    };
    if !device.has_links() {
        return;
    }
    let mut statics = Statics::new(device);
    let mut angles = vec![0.0; device.joints.len()];
    for row in 0..recording.len() {
        let force_n = Vector3::from(axes.each_ref().map(|axis| axis[row]));
        if force_n == Vector3::zeros() {
            continue;
        }
        recording.read_joints(row, &mut angles);
        statics.choose_hand(device.hand_at(recording, row));
        let mut torques = |hand: Option<Vector3<f64>>| {
            let load = statics.load(&angles, |_| hand).ok()?;
            Some(load.torques_nm.to_vec())
        };
        let both = torques(Some(force_n)).zip(torques(None));
        for (joint, column) in recording.torque_nm.iter_mut().enumerate() {
            let of_hand =
                (both.as_ref()).map_or(f64::NAN, |(with, bare)| with[joint] - bare[joint]);
            column.iter_mut().for_each(|column| column[row] -= of_hand);
        }
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
