//! A recording's torques without what the device's effects add to them, and as a base model takes them.

use haptical_model::{AddedBy, Device, Recording, Statics, varies};
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
    if !varies(&torque_nm) {
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

/// The recording as a base model takes it: its torques have nothing at the handle and no effect that is a share of the reading. What
/// other effects add to torques is kept for the base model ([`crate::fit::file_effects`]).
fn for_base(device: &Device, recording: &Recording) -> Recording {
    let mut with = recording.clone();
    with.added.clear();
    for added in &recording.added {
        let mut joints = device.joints.iter().zip(1..);
        let joint = joints.position(|(joint, number)| joint.torque_column(number) == added.channel);
        let Some(Some(torque_nm)) = joint.map(|joint| &mut with.torque_nm[joint]) else {
            continue;
        };
        // a column of one value was not measured: no effect is a share of it
        let is_share = added.by == AddedBy::Reading && varies(torque_nm);
        for (torque, added) in torque_nm.iter_mut().zip(&added.readings) {
            match is_share {
                true => *torque -= added,
                // the model has no value where an effect has none
                false if added.is_nan() => *torque = f64::NAN,
                false => {}
            }
        }
        if added.by != AddedBy::Reading {
            with.added.push(added.clone());
        }
    }
    take_off_hand(device, &mut with);
    with
}

/// Takes the torques that hold the force of the hand off those of the drives. A row without a reading of the force, or at which the
/// device has no value, has no torque.
fn take_off_hand(device: &Device, recording: &mut Recording) {
    let of_hand = hand_torques(device, recording);
    recording.force_n = None;
    for (column, of_hand) in recording.torque_nm.iter_mut().zip(of_hand) {
        for (torque, of_hand) in column.iter_mut().flatten().zip(of_hand) {
            *torque -= of_hand;
        }
    }
}

/// Torques that hold the recorded force of the hand, joint by joint and row by row: the principle of virtual work (Craig 2018, section
/// 5.10). NaN at a row without a reading of the force, or at which the device has no value; no joints without a force or links.
pub(crate) fn hand_torques(device: &Device, recording: &Recording) -> Vec<Vec<f64>> {
    let Some(axes) = recording.force_n.as_ref().filter(|_| device.has_links()) else {
        return Vec::new();
    };
    let mut statics = Statics::new(device);
    let mut angles = vec![0.0; device.joints.len()];
    let mut found = vec![vec![0.0; recording.len()]; device.joints.len()];
    for row in 0..recording.len() {
        let force_n = Vector3::from(axes.each_ref().map(|axis| axis[row]));
        if force_n == Vector3::zeros() {
            continue;
        }
        recording.read_joints(row, &mut angles);
        statics.choose_hand(device.hand_at(recording, row));
        // the sensor turns with the handle
        let mut torques = |hand: Option<Vector3<f64>>| {
            let load = statics.load(&angles, |handle| Some(handle.rotation * hand?));
            let load = load.ok()?;
            Some(load.torques_nm.to_vec())
        };
        let is_read = force_n.iter().all(|force| force.is_finite());
        let both = torques(Some(force_n)).zip(torques(None));
        let both = both.filter(|_| is_read);
        for (joint, column) in found.iter_mut().enumerate() {
            column[row] =
                (both.as_ref()).map_or(f64::NAN, |(with, bare)| with[joint] - bare[joint]);
        }
    }
    found
}

/// A log and a second one.
pub(crate) struct Logs {
    pub(crate) log: Recording,
    pub(crate) second: Option<Recording>,
}

impl Logs {
    pub(crate) fn new(device: &Device, log: &Recording, second: Option<&Recording>) -> Self {
        Self {
            log: for_base(device, log),
            second: second.map(|second| for_base(device, second)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two bars of 0.4 m and 0.3 m in a plane, the second at a right angle: the handle is at (0.4, 0.3), its x along y. A push of 10 N along
    /// the handle's x acts along y: at 0.4 m from the first axis, and along the second bar.
    #[test]
    fn a_force_in_the_handles_frame_is_taken_off_by_its_levers() {
        let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n[[link]]\na_m = 0.4\nalpha_rad = 0.0\nd_m = 0.0\n\
                    [[link]]\na_m = 0.3\nalpha_rad = 0.0\nd_m = 0.0\n[[joint]]\n[[joint]]\n";
        let device = Device::from_toml(text, "bars.toml").unwrap().device;
        let right = std::f64::consts::FRAC_PI_2;
        let push = |along: f64, across: f64| {
            let mut log = Recording {
                line: vec![2],
                joint: vec![vec![0.0], vec![right]],
                torque_nm: vec![Some(vec![1.0]), Some(vec![1.0])],
                force_n: Some([vec![along], vec![across], vec![0.0]]),
                ..Recording::default()
            };
            take_off_hand(&device, &mut log);
            log.torque_nm.into_iter().flatten().map(|own| own[0])
        };
        // a drive that resists the push exerts its negative; without the push it would exert that much more
        for (found, wanted) in push(10.0, 0.0).zip([1.0 + 4.0, 1.0]) {
            assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
        }
        // along -x: 0.3 m above both axes
        for (found, wanted) in push(0.0, 10.0).zip([1.0 + 3.0, 1.0 + 3.0]) {
            assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
        }
        assert!(push(f64::NAN, 0.0).all(f64::is_nan));
    }
}
