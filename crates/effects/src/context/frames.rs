//! Frames of the links at every row.

use haptical_model::kinematics::Convention;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, DeviceChain};

/// Frames of a device along a recording.
#[derive(Debug, Default)]
pub(super) struct Frames {
    /// Origin of the frame that each joint turns in, per joint and row.
    pub(super) origin: Vec<Vec<Vector3<f64>>>,
    /// Where row 0 ends: the robot's base.
    pub(super) base: Vec<Vector3<f64>>,
}

impl Frames {
    /// Frames at given output angles; nothing for a device without links, nor for one with rows that
    /// follow another's joint: a joint then moves what is behind it about several axes.
    pub(super) fn new(device: &Device, output: &[Vec<f64>], rows: usize) -> Self {
        let mut frames = Self::default();
        if !device.has_links() || !device.drives_are_plain() {
            return frames;
        }
        let chain = DeviceChain::new(device);
        let joints = output.len();
        frames.origin = vec![Vec::with_capacity(rows); joints];
        for row in 0..rows {
            let angles: Vec<f64> = output.iter().map(|column| column[row]).collect();
            for link in 0..joints {
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
                frames.origin[link].push(origin);
            }
        }
        frames
    }
}
