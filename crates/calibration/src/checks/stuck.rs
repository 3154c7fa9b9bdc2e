//! Columns that were not measured: one value throughout, while the device moves what they are of.

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::{Device, Recording};

use crate::CalibrationError;
use crate::start::prepare::handle_poses;

/// Fewest rows: an arm at one posture repeats what a coarse sensor reads.
const LEAST_ROWS: usize = 8;
/// Root mean square by which the device file's handle, or a joint, moves at least where a reading of it has to change \[m or rad\]: far
/// above any play, below any motion that a recording is made of.
const MOVED: f64 = 0.01;

/// Refuses a recording in which a tracker's axes or turns, a cable or an external encoder have one value throughout, though the joints
/// move what they are of by far.
///
/// # Errors
/// [`CalibrationError::Stuck`] naming the columns.
pub(crate) fn check(device: &Device, recording: &Recording) -> Result<(), CalibrationError> {
    if recording.len() < LEAST_ROWS {
        return Ok(());
    }
    let mut of_handle = (recording.position_m.iter().flatten())
        .chain(recording.orientation_wxyz.iter().flatten())
        .chain(recording.cable_m.iter().flatten());
    let is_asked = device.has_links() && of_handle.any(|column| is_one(column.iter()));
    let poses = is_asked.then(|| handle_poses(device, recording).ok());
    let poses = poses.flatten().unwrap_or_default();
    let columns = [
        positions(recording, &poses),
        turns(recording, &poses),
        cables(device, recording, &poses),
        outputs(recording),
    ];
    let columns = columns.concat();
    match columns.is_empty() {
        true => Ok(()),
        false => Err(CalibrationError::Stuck { columns }),
    }
}

/// Axes of a tracker: as many as read one value need as many directions in which the handle rests.
fn positions(recording: &Recording, poses: &[Pose]) -> Vec<String> {
    let Some(read) = &recording.position_m else {
        return Vec::new();
    };
    let stuck: Vec<&str> = (["x_m", "y_m", "z_m"].into_iter().enumerate())
        .filter(|(axis, _)| is_one(read[*axis].iter()))
        .map(|(_, name)| name)
        .collect();
    let seen = poses
        .iter()
        .zip(&read[0])
        .filter(|(_, read)| read.is_finite());
    let places: Vec<Vector3<f64>> = seen.map(|(pose, _)| pose.position_m).collect();
    let mut moved = principal_sd(&places);
    moved.sort_by(f64::total_cmp);
    let least = stuck.len().checked_sub(1).map(|last| moved[last]);
    match least.is_some_and(|least| least > MOVED) {
        true => stuck.into_iter().map(str::to_owned).collect(),
        false => Vec::new(),
    }
}

/// Standard deviations along the principal axes.
fn principal_sd(places: &[Vector3<f64>]) -> [f64; 3] {
    let count = places.len().max(1) as f64;
    let mean = places.iter().sum::<Vector3<f64>>() / count;
    let squares = places
        .iter()
        .map(|place| (place - mean) * (place - mean).transpose());
    let values = (squares.sum::<Matrix3<f64>>() / count).symmetric_eigenvalues();
    std::array::from_fn(|axis| values[axis].max(0.0).sqrt())
}

fn turns(recording: &Recording, poses: &[Pose]) -> Vec<String> {
    let Some(read) = &recording.orientation_wxyz else {
        return Vec::new();
    };
    let is_stuck = read.iter().all(|part| is_one(part.iter()));
    let seen: Vec<&Pose> = (poses.iter().zip(&read[0]))
        .filter(|(_, read)| read.is_finite())
        .map(|(pose, _)| pose)
        .collect();
    let angle_rad = |pose: &&Pose| {
        let turn = seen[0].rotation.transpose() * pose.rotation;
        ((turn.trace() - 1.0) / 2.0).clamp(-1.0, 1.0).acos()
    };
    let square = seen.iter().map(|pose| angle_rad(pose).powi(2)).sum::<f64>();
    let moved = (square / seen.len().max(1) as f64).sqrt();
    match is_stuck && moved > MOVED {
        true => vec!["the orientation".to_owned()],
        false => Vec::new(),
    }
}

fn cables(device: &Device, recording: &Recording, poses: &[Pose]) -> Vec<String> {
    let read = recording.cable_m.iter().enumerate();
    let is_stuck = |(index, read): &(usize, &Option<Vec<f64>>)| {
        let Some((read, cable)) = read.as_ref().zip(device.cables.get(*index)) else {
            return false;
        };
        let anchor_m = Vector3::from(cable.anchor_m);
        let seen = poses.iter().zip(read).filter(|(_, read)| read.is_finite());
        let lengths = seen.map(|(pose, _)| (pose.position_m - anchor_m).norm());
        is_one(read.iter()) && sd(lengths) > MOVED
    };
    let name = |(index, _): (usize, &Option<Vec<f64>>)| match index {
        0 => "cable_m".to_owned(),
        more => format!("cable{}_m", more + 1),
    };
    read.filter(is_stuck).map(name).collect()
}

fn outputs(recording: &Recording) -> Vec<String> {
    let read = recording.output.iter().zip(&recording.joint).enumerate();
    let is_stuck = |(_, (read, joint)): &(usize, (&Option<Vec<f64>>, &Vec<f64>))| {
        read.as_ref().is_some_and(|read| {
            let seen = joint.iter().zip(read).filter(|(_, read)| read.is_finite());
            is_one(read.iter()) && sd(seen.map(|(joint, _)| *joint)) > MOVED
        })
    };
    let name = |(joint, _): (usize, _)| format!("out{}_rad", joint + 1);
    read.filter(is_stuck).map(name).collect()
}

/// Whether a column has one value, in rows enough.
pub(super) fn is_one<'c>(column: impl Iterator<Item = &'c f64>) -> bool {
    let mut read = column.filter(|value| value.is_finite());
    let Some(first) = read.next() else {
        return false;
    };
    let mut rows = 1;
    let is_same = |value: &f64| {
        rows += 1;
        value.to_bits() == first.to_bits()
    };
    read.all(is_same) && rows >= LEAST_ROWS
}

fn sd(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares = values.iter().map(|value| (value - mean).powi(2));
    (squares.sum::<f64>() / count).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two bars of 0.3 m in the plane z = 0, and what a tracker and an encoder read of their motion.
    fn moved(rows: usize) -> (Device, Recording) {
        let bar = "[[link]]\na_m = 0.3\nalpha_rad = 0.0\nd_m = 0.0\n";
        let base = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n";
        let text = format!("{base}{bar}{bar}[[joint]]\n[[joint]]\n");
        let device = Device::from_toml(&text, "bars.toml").unwrap().device;
        let joint: Vec<Vec<f64>> = [0.9, 1.7]
            .map(|speed| (0..rows).map(|row| (speed * row as f64).sin()).collect())
            .to_vec();
        let mut recording = Recording {
            line: (2..).take(rows).collect(),
            output: vec![Some(joint[0].clone()), None],
            torque_nm: vec![None, None],
            joint,
            ..Recording::default()
        };
        let poses = handle_poses(&device, &recording).unwrap();
        let axis = |axis: usize| poses.iter().map(|pose| pose.position_m[axis]).collect();
        recording.position_m = Some([0, 1, 2].map(axis));
        (device, recording)
    }

    fn columns(device: &Device, recording: &Recording) -> Vec<String> {
        match check(device, recording) {
            Err(CalibrationError::Stuck { columns }) => columns,
            other => {
                assert!(other.is_ok(), "{other:?}");
                Vec::new()
            }
        }
    }

    #[test]
    fn a_column_of_one_value_is_stuck_where_the_arm_moves_what_it_is_of() {
        // the height of an arm in a plane is one value
        let (device, sound) = moved(20);
        assert!(columns(&device, &sound).is_empty());
        let stuck = |axes: &[usize]| {
            let mut log = sound.clone();
            let read = log.position_m.as_mut().unwrap();
            axes.iter().for_each(|axis| read[*axis].fill(0.25));
            columns(&device, &log)
        };
        assert_eq!(stuck(&[0]), ["x_m", "z_m"]);
        assert_eq!(stuck(&[0, 1]), ["x_m", "y_m", "z_m"]);
        let mut log = sound.clone();
        log.output[0].as_mut().unwrap().fill(0.1);
        assert_eq!(columns(&device, &log), ["out1_rad"]);
        // a joint that rests
        log.joint[0].fill(0.1);
        log.position_m = None;
        assert!(columns(&device, &log).is_empty());
    }

    #[test]
    fn few_rows_may_repeat_a_reading() {
        let (device, mut log) = moved(LEAST_ROWS - 1);
        log.output[0].as_mut().unwrap().fill(0.1);
        assert!(columns(&device, &log).is_empty());
    }
}
