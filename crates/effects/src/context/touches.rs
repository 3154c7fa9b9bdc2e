//! Displacements of the handle as touches of points and planes show them.

use haptical_calibration::Channel;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::{Device, DeviceChain, Recording};

use super::stream::Stream;

/// Directions in which touches are read (docs/diagnosis.md, "Touches").
#[derive(Debug, Default)]
pub struct Touches {
    /// The base's axes as rows: touches of points are read along them.
    into_base: Matrix3<f64>,
    /// Normals of the touched planes, frame (-1).
    normals: Vec<Vector3<f64>>,
    /// Which plane a row touches.
    plane: Vec<Option<usize>>,
}

impl Touches {
    /// Directions of a device whose touched points and planes are placed.
    pub fn new(device: &Device, recording: &Recording) -> Self {
        let chain = DeviceChain::new(device);
        let base = chain.part(1).and_then(|chain| chain.pose(&[]));
        let surroundings = &device.surroundings;
        let plane = recording.plane.as_ref().map(|ids| {
            ids.iter()
                .map(|id| surroundings.plane_index(id))
                .collect::<Vec<_>>()
        });
        Self {
            // a chain without a pose has no streams behind it either
            into_base: base.map_or_else(|_| Matrix3::identity(), |base| base.rotation.transpose()),
            normals: surroundings
                .planes
                .iter()
                .map(|plane| plane.normal_and_slopes().0)
                .collect(),
            plane: plane.unwrap_or_default(),
        }
    }

    /// The direction in which a stream of touches shows a displacement of the handle at a row.
    pub fn direction(&self, stream: &Stream, row: usize) -> Vector3<f64> {
        let along = |linear: &Vector3<f64>| match stream.channel {
            Channel::Plane => self.along_plane(row, linear),
            _ => self.along_contact(stream.axis, linear),
        };
        Vector3::from_fn(|axis, _| along(&Vector3::ith(axis, 1.0)))
    }

    /// What an axis of a touched point shows of a displacement.
    pub fn along_contact(&self, axis: usize, linear: &Vector3<f64>) -> f64 {
        self.into_base.row(axis).transpose().dot(linear)
    }

    /// What a touched plane shows of a displacement: its normal component.
    pub fn along_plane(&self, row: usize, linear: &Vector3<f64>) -> f64 {
        let plane = self.plane.get(row).copied().flatten();
        plane.map_or(0.0, |plane| self.normals[plane].dot(linear))
    }
}
