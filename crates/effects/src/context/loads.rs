//! Loads of drives and base at rest, row by row, by the model's statics.

use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, Recording, Statics};

use crate::ContextError;

/// A place or a force in each row.
type Rows = Vec<Vector3<f64>>;

/// Loads at rest, by the model's statics.
pub(super) struct Loads {
    /// Per joint and row.
    pub(super) torque_nm: Vec<Vec<f64>>,
    /// Per row, frame (-1).
    pub(super) base_moment_nm: Vec<Vector3<f64>>,
    /// Of all beyond each joint about its origin, frame (-1), per joint and row.
    pub(super) joint_moment_nm: Vec<Vec<Vector3<f64>>>,
}

/// Torques of the drives and moment about the base that hold masses and hand; none where neither masses
/// with gravity nor forces are known.
pub(super) fn loads(
    device: &Device,
    recording: &Recording,
    output: &[Vec<f64>],
    (origin, force_n): (&[Rows], Option<&[Vector3<f64>]>),
) -> Result<Option<Loads>, ContextError> {
    let mut statics = Statics::new(device);
    if !statics.has_weights() && force_n.is_none() {
        return Ok(None);
    }
    let rows = output.first().map_or(0, Vec::len);
    let mut loads = Loads {
        torque_nm: vec![Vec::with_capacity(rows); output.len()],
        base_moment_nm: Vec::with_capacity(rows),
        joint_moment_nm: vec![Vec::with_capacity(rows); origin.len()],
    };
    let mut angles = vec![0.0; output.len()];
    for row in 0..rows {
        for (angle, column) in angles.iter_mut().zip(output) {
            *angle = column[row];
        }
        statics.choose_hand(device.hand_at(recording, row));
        let load = statics.load(&angles, |_| force_n.map(|force| force[row]));
        let load = load.map_err(|source| ContextError::Row {
            line: recording.line.get(row).copied().unwrap_or(0),
            source: source.into(),
        })?;
        for (column, torque) in loads.torque_nm.iter_mut().zip(load.torques_nm) {
            column.push(*torque);
        }
        loads.base_moment_nm.push(load.base_moment_nm);
        let beyond = load.beyond.iter().zip(origin);
        for (column, (beyond, origin)) in loads.joint_moment_nm.iter_mut().zip(beyond) {
            column.extend(origin.get(row).map(|origin| beyond.moment_about_nm(origin)));
        }
    }
    Ok(Some(loads))
}
