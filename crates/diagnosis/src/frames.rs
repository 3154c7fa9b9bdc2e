//! Where the links stand at every row, and the loads that hand and gravity put on them.

use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::kinematics::{Convention, Twist};
use haptical_model::{Device, DeviceChain, JointType};

/// Frames and masses of a device along a recording.
#[derive(Debug, Default)]
pub(crate) struct Frames {
    /// Origin of the frame that each joint turns in, per joint and row.
    pub(crate) origin: Vec<Vec<Vector3<f64>>>,
    /// Centre of mass times mass of each link that has one: link (0 the base row), mass, places.
    masses: Vec<(usize, f64, Vec<Vector3<f64>>)>,
    /// Where row 0 ends: the robot's base.
    pub(crate) base: Vec<Vector3<f64>>,
    gravity_mps2: Option<Vector3<f64>>,
}

impl Frames {
    /// Frames at given output angles; nothing for a device without links, nor for one with rows that
    /// follow another's joint: a joint then moves what is behind it about several axes.
    pub(crate) fn new(device: &Device, output: &[Vec<f64>], rows: usize) -> Self {
        let mut frames = Self {
            gravity_mps2: device.gravity_mps2.map(Vector3::from),
            ..Self::default()
        };
        if !device.has_links() || !device.drives_are_plain() {
            return frames;
        }
        let chain = DeviceChain::new(device);
        let joints = output.len();
        frames.origin = vec![Vec::with_capacity(rows); joints];
        let mut masses: Vec<(usize, f64, Vec<Vector3<f64>>)> = device
            .bodies
            .iter()
            .enumerate()
            .filter_map(|(link, body)| Some((link, (*body)?.mass_kg, Vec::with_capacity(rows))))
            .filter(|(link, mass, _)| *link > 0 && *mass > 0.0)
            .collect();
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
                let mut own = chain.links[link + 1];
                let mut origin = pose.position_m;
                if device.convention == Convention::Modified {
                    // Craig's rows turn and shift along x before the joint moves
                    origin += pose.rotation * Vector3::new(own.a_m, own.b_m, 0.0);
                }
                frames.origin[link].push(origin);
                if let Some((_, _, places)) = masses.iter_mut().find(|(of, _, _)| *of == link + 1)
                    && let Some(body) = device.bodies[link + 1]
                {
                    let centre = Vector3::from(body.centre_of_mass_m);
                    let turning = device.joints[link].joint_type == JointType::Revolute;
                    own.theta_rad += if turning { angles[link] } else { 0.0 };
                    let (sin, cos) = own.theta_rad.sin_cos();
                    let turned = Vector3::new(
                        cos * centre.x - sin * centre.y,
                        sin * centre.x + cos * centre.y,
                        centre.z,
                    );
                    let turned = if device.convention == Convention::Modified {
                        let (sin, cos) = own.alpha_rad.sin_cos();
                        Vector3::new(
                            turned.x,
                            cos * turned.y - sin * turned.z,
                            sin * turned.y + cos * turned.z,
                        )
                    } else {
                        turned
                    };
                    places.push(origin + pose.rotation * turned);
                }
            }
        }
        frames.masses = masses;
        frames
    }

    /// Torque that the drive of a joint needs to hold masses and hand at rest, positive along the
    /// joint: minus what gravity and the hand exert (virtual work; Siciliano et al. 2009, section 7.1).
    /// None where neither masses nor forces are known.
    pub(crate) fn holding_torque(
        &self,
        twist: &[Vec<Twist>],
        position: &[Vector3<f64>],
        force_n: Option<&[Vector3<f64>]>,
        joint: usize,
    ) -> Option<Vec<f64>> {
        let gravity = self.gravity_mps2.filter(|_| !self.masses.is_empty());
        if gravity.is_none() && force_n.is_none() {
            return None;
        }
        let twist = twist.get(joint)?;
        let torque = twist.iter().enumerate().map(|(row, twist)| {
            let moved = |place: &Vector3<f64>| {
                // the handle's velocity carried over to another point of the same link
                twist.linear + twist.angular.cross(&(place - position[row]))
            };
            let weights: f64 = match &gravity {
                None => 0.0,
                Some(gravity) => self
                    .masses
                    .iter()
                    .filter(|(link, _, _)| *link > joint)
                    .map(|(_, mass, places)| mass * gravity.dot(&moved(&places[row])))
                    .sum(),
            };
            let hand = force_n.map_or(0.0, |force| force[row].dot(&twist.linear));
            -(weights + hand)
        });
        Some(torque.collect())
    }

    /// Moment of hand and weights about the robot's base.
    pub(crate) fn base_moment(
        &self,
        position: &[Vector3<f64>],
        force_n: Option<&[Vector3<f64>]>,
    ) -> Option<Vec<Vector3<f64>>> {
        let gravity = self.gravity_mps2.filter(|_| !self.masses.is_empty());
        if (gravity.is_none() && force_n.is_none()) || self.base.is_empty() {
            return None;
        }
        let moment = (0..position.len()).map(|row| {
            let base = self.base[row];
            let hand = force_n.map_or_else(Vector3::zeros, |force| {
                (position[row] - base).cross(&force[row])
            });
            let weights: Vector3<f64> = match &gravity {
                None => Vector3::zeros(),
                Some(gravity) => self
                    .masses
                    .iter()
                    .map(|(_, mass, places)| (places[row] - base).cross(gravity) * *mass)
                    .sum(),
            };
            hand + weights
        });
        Some(moment.collect())
    }
}
