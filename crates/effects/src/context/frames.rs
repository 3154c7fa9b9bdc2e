//! Frames of the links at every row.

use haptical_model::kinematics::Convention;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, DeviceChain};

/// Frames of a device along a recording.
#[derive(Debug, Default)]
pub(super) struct Frames {
    /// Origin of the frame that each joint turns in, per joint and row; empty of a joint that moves several rows of the chain,
    /// each about an axis of its own.
    pub(super) origin: Vec<Vec<Vector3<f64>>>,
    /// Where row 0 ends: the robot's base.
    pub(super) base: Vec<Vector3<f64>>,
}

impl Frames {
    /// Frames at given output angles; nothing for a device without links.
    pub(super) fn new(device: &Device, output: &[Vec<f64>], rows: usize) -> Self {
        let mut frames = Self::default();
        if !device.has_links() {
            return frames;
        }
        let chain = DeviceChain::new(device);
        let drives = chain.drives();
        let moved_rows = |joint| drives.iter().filter(|drive| drive.joint == joint).count();
        let is_alone: Vec<bool> = drives
            .iter()
            .map(|drive| moved_rows(drive.joint) == 1)
            .collect();
        frames.origin = vec![Vec::with_capacity(rows); output.len()];
        let mut outputs = vec![0.0; output.len()];
        let mut angles = vec![0.0; drives.len()];
        for row in 0..rows {
            for (angle, column) in outputs.iter_mut().zip(output) {
                *angle = column[row];
            }
            chain.variables(&outputs, &mut angles);
            for link in (0..drives.len()).filter(|link| *link == 0 || is_alone[*link]) {
                // rows 0 to `link` end in the frame that joint link + 1 moves in
                let pose = chain
                    .part(link + 1)
                    .and_then(|chain| chain.pose(&angles[..link]));
                let Ok(mut pose) = pose else {
                    return Self::default();
                };
                if link == 0 {
                    frames.base.push(pose.position_m);
                }
                if !is_alone[link] {
                    continue;
                }
                if let Some(Some(origin)) = chain.origins().get(link + 1) {
                    pose.position_m += pose.rotation * origin.position_m;
                    pose.rotation *= origin.rotation;
                }
                let own = chain.links[link + 1];
                let mut origin = pose.position_m;
                if device.convention == Convention::Modified {
                    // Craig's rows turn and shift along x before the joint moves
                    origin += pose.rotation * Vector3::new(own.a_m, own.b_m, 0.0);
                }
                frames.origin[drives[link].joint].push(origin);
            }
        }
        frames
    }
}
