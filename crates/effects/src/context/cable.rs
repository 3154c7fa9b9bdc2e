//! The first cable at every row: how long it is, where it points, how it moves.

use std::ops::Range;

use haptical_calibration::Channel;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, Evaluation};

use super::stream::{Stream, stream_of};
use crate::signal::{LocalMotion, local_motion};

/// The first cable at every row.
#[derive(Debug, Clone)]
pub struct CableGeometry {
    /// Its stream.
    pub stream: usize,
    /// Distance by the model \[m\].
    pub length_m: Vec<f64>,
    /// From the exit to the handle, frame (-1).
    pub direction: Vec<Vector3<f64>>,
    /// Where the cable leaves its guide straight.
    pub exit_axis: Vector3<f64>,
    /// How its length changes in time.
    pub motion: LocalMotion,
}

impl CableGeometry {
    /// Angle between the cable and the axis along which it leaves its guide straight.
    pub(crate) fn exit_angle_rad(&self, row: usize) -> f64 {
        let cosine = self.direction[row].dot(&self.exit_axis).clamp(-1.0, 1.0);
        let sine = self.direction[row].cross(&self.exit_axis).norm();
        sine.atan2(cosine)
    }
}

/// Exit of a cable, frame (-1) \[m\].
pub(super) fn anchor_m(device: &Device, index: usize) -> Vector3<f64> {
    let cable = device.cables.get(index);
    Vector3::from(cable.map_or([0.0; 3], |cable| cable.anchor_m))
}

pub(super) fn cable_geometry(
    device: &Device,
    streams: &[Stream],
    position: &[Vector3<f64>],
    time_s: Option<&[f64]>,
    runs: &[Range<usize>],
) -> Option<CableGeometry> {
    let stream = stream_of(streams, Channel::Cable { index: 0 })?;
    let cable = device.cables.first();
    let anchor = anchor_m(device, 0);
    let length_m: Vec<f64> = position.iter().map(|p| (p - anchor).norm()).collect();
    let direction: Vec<Vector3<f64>> = position
        .iter()
        .map(|p| (p - anchor).try_normalize(1e-12).unwrap_or(Vector3::x()))
        .collect();
    let exit_axis = match cable.and_then(|cable| cable.exit_axis) {
        Some(axis) => Vector3::from(axis),
        None => {
            let mut home = Evaluation::new(device);
            let readings = vec![0.0; device.joints.len()];
            match home.move_to(&readings) {
                Ok(()) => home
                    .pose()
                    .map_or(Vector3::x(), |pose| pose.position_m - anchor),
                Err(_) => direction.iter().sum(),
            }
        }
    };
    let motion = match time_s {
        Some(time_s) => local_motion(&length_m, time_s, runs),
        None => LocalMotion::default(),
    };
    Some(CableGeometry {
        stream,
        length_m,
        direction,
        exit_axis: exit_axis.try_normalize(1e-12).unwrap_or(Vector3::x()),
        motion,
    })
}
