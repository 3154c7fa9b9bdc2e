//! Frames of the links at every row.

use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::kinematics::{Convention, Pose};
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
    /// Frames at given output angles, of a device that has links.
    pub(super) fn new(device: &Device, output: &[Vec<f64>], rows: usize) -> Self {
        let mut frames = Self::default();
        // rows 0 to the one that a row hangs on end in the frame that the row's joint moves in
        let moved: Vec<Moved> = (1..device.links.len())
            .filter_map(|row| Moved::new(device, row))
            .collect();
        let base = DeviceChain::to_row(device, 0);
        frames.origin = vec![Vec::with_capacity(rows); output.len()];
        let mut outputs = vec![0.0; output.len()];
        let mut angles = vec![0.0; device.links.len()];
        for row in 0..rows {
            for (angle, column) in outputs.iter_mut().zip(output) {
                *angle = column[row];
            }
            let Ok(pose) = base.chain().and_then(|chain| chain.pose(&[])) else {
                return Self::default();
            };
            frames.base.push(pose.position_m);
            for own in &moved {
                let Some(origin) = own.origin_m(&outputs, &mut angles) else {
                    return Self::default();
                };
                frames.origin[own.joint].push(origin);
            }
        }
        frames
    }
}

/// Origin of the frame that a joint (from 0) turns in \[m\], frame (-1), when all joint values are 0; none of a joint that is
/// not there, or that moves several rows of the chain.
///
/// ```
/// let text = "[[link]]\na_m = 0.2\nalpha_rad = 0.0\nd_m = 0.1\n\
///     [[link]]\na_m = 0.4\nalpha_rad = 0.0\nd_m = 0.0\n[[joint]]\n";
/// let device = haptical_model::Device::from_toml(text, "lever.toml")?.device;
/// let origin_m = haptical_effects::joint_origin_m(&device, 0).ok_or("none")?;
/// assert_eq!((origin_m.x, origin_m.z), (0.2, 0.1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn joint_origin_m(device: &Device, joint: usize) -> Option<Vector3<f64>> {
    let of_joint = |row: &usize| device.drive(*row).is_some_and(|drive| drive.joint == joint);
    let row = (1..device.links.len()).find(of_joint)?;
    let outputs = vec![0.0; device.joints.len()];
    let mut angles = vec![0.0; device.links.len()];
    Moved::new(device, row)?.origin_m(&outputs, &mut angles)
}

/// A row that moves alone with its joint.
struct Moved {
    joint: usize,
    /// Up to the row that it hangs on.
    before: DeviceChain,
    origin: Pose,
    /// From the row's frame to its axis: Craig's rows turn and shift along x before the joint moves.
    shift_m: Vector3<f64>,
}

impl Moved {
    /// None for a row that is not its joint's only one.
    fn new(device: &Device, row: usize) -> Option<Self> {
        let joint = device.drive(row)?.joint;
        let mut others = (1..device.links.len()).filter_map(|other| device.drive(other));
        if others.by_ref().filter(|other| other.joint == joint).count() != 1 {
            return None;
        }
        let origin = device.origins.get(row).copied().flatten();
        let own = device.links.get(row)?;
        Some(Self {
            joint,
            before: DeviceChain::to_row(device, device.parent(row)?),
            origin: origin.unwrap_or_default().pose(),
            shift_m: match device.convention {
                Convention::Standard => Vector3::zeros(),
                Convention::Modified => Vector3::new(own.a_m, own.b_m, 0.0),
            },
        })
    }

    fn origin_m(&self, outputs: &[f64], angles: &mut [f64]) -> Option<Vector3<f64>> {
        let angles = &mut angles[..self.before.drives().len()];
        self.before.variables(outputs, angles);
        let pose = self
            .before
            .chain()
            .and_then(|chain| chain.pose(angles))
            .ok()?;
        let turned = pose.rotation * self.origin.rotation;
        Some(pose.position_m + pose.rotation * self.origin.position_m + turned * self.shift_m)
    }
}
