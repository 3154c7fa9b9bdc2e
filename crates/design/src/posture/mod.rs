//! Candidate poses of a rig, and the recording that it would make of them without noise.

pub(crate) mod candidates;
pub(crate) mod clearance;
pub(crate) mod touches;

use haptical_model::kinematics::nalgebra::{Rotation3, UnitQuaternion};
use haptical_model::{Device, Evaluation, Recording};

use crate::{DesignError, Equipped, Limits, candidates};

/// A pose that may be measured, and what the handle touches in it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Posture {
    /// Reading of each joint (\[rad\], \[m\] for a prismatic joint).
    pub readings: Vec<f64>,
    /// Socket that the handle sits in; empty for none.
    pub contact: String,
    /// Plane that it touches; empty for none.
    pub plane: String,
}

impl Posture {
    /// A pose that touches nothing.
    pub fn free(readings: Vec<f64>) -> Self {
        Self {
            readings,
            ..Self::default()
        }
    }

    /// Whether the handle touches a socket or a plane.
    pub fn touches(&self) -> bool {
        !self.contact.is_empty() || !self.plane.is_empty()
    }
}

/// Draws the candidate poses of a rig: as [`candidates`]; where the rig has sockets or planes these are placed
/// in the device's workspace and each pose touches one of them, in turn.
///
/// # Errors
/// As [`candidates`].
pub fn postures(
    equipped: &mut Equipped,
    limits: &Limits,
    count: usize,
    seed: u64,
) -> Result<Vec<Posture>, DesignError> {
    if let Some(touching) = touches::postures(equipped, limits, count, seed)? {
        return Ok(touching);
    }
    let free = candidates(&equipped.device, limits, count, seed)?;
    Ok(free.into_iter().map(Posture::free).collect())
}

/// The recording of postures without noise: every reading that the rig could make is there.
pub(crate) fn recording(
    equipped: &Equipped,
    postures: &[Posture],
) -> Result<Recording, DesignError> {
    recording_of(&equipped.device, postures)
}

/// The same of a device whose sensors are its own.
pub(crate) fn recording_of(
    device: &Device,
    postures: &[Posture],
) -> Result<Recording, DesignError> {
    let mut evaluation = Evaluation::new(device);
    let mut recording = empty(device, postures.len());
    for (row, posture) in postures.iter().enumerate() {
        let refuse = DesignError::of_pose(row);
        evaluation.move_to(&posture.readings).map_err(&refuse)?;
        recording.line.push(row as u64 + 1);
        for (joint, reading) in posture.readings.iter().enumerate() {
            recording.joint[joint].push(*reading);
            if let Some(column) = &mut recording.output[joint] {
                column.push(evaluation.output_rad(joint));
            }
        }
        if !device.has_links() {
            continue;
        }
        let pose = evaluation.pose().map_err(&refuse)?;
        for (cable, column) in device.cables.iter().zip(&mut recording.cable_m) {
            let read = cable.reading(&pose.position_m);
            let read = read.map_err(|source| refuse(source.into()))?;
            column.get_or_insert_default().push(read.reading_m);
        }
        let tracked = tracked(device, pose);
        for (axis, column) in recording.position_m.iter_mut().flatten().enumerate() {
            column.push(tracked.position_m[axis]);
        }
        let turn = Rotation3::from_matrix_unchecked(tracked.rotation);
        let turn = UnitQuaternion::from_rotation_matrix(&turn);
        let parts = [turn.w, turn.i, turn.j, turn.k];
        let columns = recording.orientation_wxyz.iter_mut().flatten();
        columns
            .zip(parts)
            .for_each(|(column, part)| column.push(part));
    }
    let touched = |of: fn(&Posture) -> &String| -> Option<Vec<String>> {
        let ids: Vec<String> = postures.iter().map(|posture| of(posture).clone()).collect();
        ids.iter().any(|id| !id.is_empty()).then_some(ids)
    };
    recording.contact = touched(|posture| &posture.contact);
    recording.plane = touched(|posture| &posture.plane);
    Ok(recording)
}

fn empty(device: &Device, rows: usize) -> Recording {
    let column = || Vec::with_capacity(rows);
    let tracks = device.tracker.is_some() && device.has_links();
    Recording {
        joint: device.joints.iter().map(|_| column()).collect(),
        output: device.joints.iter().map(|_| Some(column())).collect(),
        cable_m: device.cables.iter().map(|_| Some(column())).collect(),
        position_m: tracks.then(|| [(); 3].map(|()| column())),
        orientation_wxyz: tracks.then(|| [(); 4].map(|()| column())),
        torque_nm: vec![None; device.joints.len()],
        ..Recording::default()
    }
}

/// What the tracker sees.
fn tracked(
    device: &Device,
    handle: &haptical_model::kinematics::Pose,
) -> haptical_model::kinematics::Pose {
    let places = &device.surroundings;
    let base = places.tracker_base.unwrap_or_default().pose();
    let tool = places.tracker_tool.unwrap_or_default().pose();
    let turned = base.rotation * handle.rotation;
    haptical_model::kinematics::Pose {
        position_m: base.position_m + base.rotation * handle.position_m + turned * tool.position_m,
        rotation: turned * tool.rotation,
    }
}
