//! A device: links, joints with their transmissions, and the sensors around it.

use haptical_kinematics::{Convention, Link, Motion};

use crate::Joint;

/// A device as its file describes it. Without links it has transmissions only.
#[derive(Debug, Clone, PartialEq)]
pub struct Device {
    /// Name.
    pub name: String,
    /// Denavit-Hartenberg convention of the rows.
    pub convention: Convention,
    /// Rows; row 0 carries frame (-1) to the base, row i belongs to joint i. `theta_rad` is the
    /// joint offset alone: home and reading are added when the device is evaluated.
    pub links: Vec<Link>,
    /// Masses of the rows, where known.
    pub bodies: Vec<Option<Body>>,
    /// Joints 1 to n.
    pub joints: Vec<Joint>,
    /// Cable encoders; the first is `[cable_encoder]`, anchored at frame (-1)'s origin.
    pub cables: Vec<Cable>,
    /// External tracker.
    pub tracker: Option<Tracker>,
    /// Contacts at a known distance from each other.
    pub contact_pairs: Vec<ContactPair>,
    /// Gravity in frame (-1) \[m/s^2\].
    pub gravity_mps2: Option<[f64; 3]>,
    /// Rows before calibration, where the file keeps them.
    pub nominal_links: Option<Vec<Link>>,
}

/// Mass of one link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Mass \[kg\].
    pub mass_kg: f64,
    /// Centre of mass in the frame after Rz(theta_i), before the translation \[m\].
    pub centre_of_mass_m: [f64; 3],
}

/// A cable encoder that measures the distance from its anchor to the handle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cable {
    /// Where the cable leaves its guide, in frame (-1) \[m\].
    pub anchor_m: [f64; 3],
    /// Radius of the encoder's drum \[m\].
    pub drum_radius_m: Option<f64>,
    /// Counts per revolution of the drum.
    pub counts_per_rev: Option<f64>,
    /// Standard deviation of a distance \[m\].
    pub distance_sd_m: Option<f64>,
    /// Direction in which the cable leaves its guide straight.
    pub exit_axis: Option<[f64; 3]>,
}

/// An external tracker of the handle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracker {
    /// Whether its readings are in frame (-1).
    pub base_known: bool,
    /// Whether it tracks the handle frame itself.
    pub tool_known: bool,
    /// Standard deviation of a coordinate \[m\].
    pub position_sd_m: Option<f64>,
    /// Standard deviation of a rotation component \[rad\].
    pub rotation_sd_rad: Option<f64>,
}

/// Two contact points at a known distance.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactPair {
    /// First contact id.
    pub a: String,
    /// Second contact id.
    pub b: String,
    /// Distance \[m\].
    pub distance_m: f64,
    /// Standard deviation of the distance \[m\].
    pub sd_m: f64,
}

impl Device {
    /// Whether the device has links, so that a handle pose can be computed.
    pub fn has_links(&self) -> bool {
        !self.links.is_empty()
    }

    /// What each row's joint variable does: row 0 is fixed, row i moves with joint i.
    pub fn motions(&self) -> Vec<Motion> {
        std::iter::once(Motion::Fixed)
            .chain(self.joints.iter().map(Joint::motion))
            .collect()
    }

    /// The rows as the chain wants them: home added to each joint's offset.
    pub fn chain_links(&self) -> Vec<Link> {
        let mut links = self.links.clone();
        for (link, joint) in links.iter_mut().skip(1).zip(&self.joints) {
            match joint.motion() {
                Motion::Prismatic => link.d_m += joint.home_rad,
                Motion::Revolute | Motion::Fixed => link.theta_rad += joint.home_rad,
            }
        }
        links
    }

    /// Standard deviation of the cable encoder at `index` \[m\]: as stated, or one third of the
    /// largest quantization error as the paper takes it for encoders.
    pub fn cable_sd_m(&self, index: usize) -> Option<f64> {
        let cable = self.cables.get(index)?;
        cable.distance_sd_m.or_else(|| {
            let quantum = std::f64::consts::TAU * cable.drum_radius_m? / cable.counts_per_rev?;
            Some(quantum / 3.0)
        })
    }
}
