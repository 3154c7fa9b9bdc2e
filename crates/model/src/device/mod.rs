//! A device: links, joints with their transmissions, and the sensors around it.

pub(crate) mod cable;
pub(crate) mod chain;
pub(crate) mod drive;
pub(crate) mod effect;
pub(crate) mod joint;
pub(crate) mod mount;
pub(crate) mod rows;
pub(crate) mod surroundings;
pub(crate) mod tree;

use std::collections::BTreeMap;

use haptical_kinematics::{Convention, Link};

use crate::Surroundings;
use crate::{Cable, DeviceEffect, Drive, Hand, Joint, Origin, Parameter};

/// A device as its file describes it. Without links it has transmissions only.
#[derive(Debug, Clone, PartialEq)]
pub struct Device {
    /// Name.
    pub name: String,
    /// Denavit-Hartenberg convention of the rows.
    pub convention: Convention,
    /// Rows; row 0 carries frame (-1) to the base, row i belongs to joint i unless
    /// [`Device::drives`] says otherwise. `theta_rad` is the
    /// joint offset alone: home and reading are added when the device is evaluated.
    pub links: Vec<Link>,
    /// Constant rigid transforms: entry i comes before row i, the last one (as many as there are links)
    /// carries the last row's frame to the handle, where the device has no [`Device::hands`]. Empty where it has none.
    pub origins: Vec<Option<Origin>>,
    /// What drives rows 1 to n; empty where row i moves with joint i alone.
    pub drives: Vec<Drive>,
    /// The row that each of rows 1 to n hangs on, an earlier one; empty where it is the row before.
    pub parents: Vec<usize>,
    /// Where chains end that a log tells apart; empty where the device is one chain up to its last row.
    pub hands: Vec<Hand>,
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
    /// How far rows' numbers may plausibly be from the device's, where somebody says so (\[m\] or \[rad\]); 0 where
    /// a calibration keeps them ([`Device::hold`], [`Device::expect_deviation`]).
    pub deviations: BTreeMap<(usize, Parameter), f64>,
    /// Numbers outside the chain that may have to be fitted with it: the tracker's place, touched points.
    pub surroundings: Surroundings,
    /// What it has beside geometry and drives: plays, springs, drifts.
    pub effects: Vec<DeviceEffect>,
}

/// Mass of one link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Mass \[kg\].
    pub mass_kg: f64,
    /// Centre of mass in the frame after Rz(theta_i), before the translation \[m\]; a slide carries it by all of its
    /// variable, home and offset included, and the row's own `d_m` does not.
    pub centre_of_mass_m: [f64; 3],
    /// Moments and products of inertia ixx, iyy, izz, ixy, ixz, iyz about the centre of mass, along the axes of the same
    /// frame \[kg m^2\]; none where nobody says. Nothing that is at rest depends on them: they are for simulators.
    pub inertia_kgm2: Option<[f64; 6]>,
}

/// An external tracker of the handle.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Tracker {
    /// Whether its readings are in frame (-1).
    pub base_known: bool,
    /// Whether it was set up anew for each run, so that each has an unknown base of its own.
    pub base_per_run: bool,
    /// Whether it tracks the handle frame itself.
    pub tool_known: bool,
    /// Standard deviation of a coordinate \[m\].
    pub position_sd_m: Option<f64>,
    /// Standard deviation of a rotation component \[rad\].
    pub rotation_sd_rad: Option<f64>,
    /// Standard deviation of its reading per length: one number for all positions.
    pub scale_sd: Option<f64>,
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
    /// A device of these rows (row 0 leads to the base) and joints, without name, sensors, masses or gravity.
    ///
    /// ```
    /// use haptical_model::kinematics::{Convention, Link};
    /// use haptical_model::{Device, Evaluation, Joint};
    ///
    /// let link = Link { a_m: 0.3, ..Link::default() };
    /// let device = Device::new(Convention::Standard, vec![Link::default(), link], vec![Joint::default()]);
    /// let mut at = Evaluation::new(&device);
    /// at.move_to(&[0.0])?;
    /// assert_eq!(at.pose()?.position_m.x, 0.3);
    /// # Ok::<(), haptical_model::ModelError>(())
    /// ```
    pub fn new(convention: Convention, links: Vec<Link>, joints: Vec<Joint>) -> Self {
        Self {
            name: String::new(),
            convention,
            bodies: vec![None; links.len()],
            links,
            joints,
            origins: Vec::new(),
            drives: Vec::new(),
            parents: Vec::new(),
            hands: Vec::new(),
            cables: Vec::new(),
            tracker: None,
            contact_pairs: Vec::new(),
            gravity_mps2: None,
            nominal_links: None,
            deviations: BTreeMap::new(),
            surroundings: Surroundings::default(),
            effects: Vec::new(),
        }
    }

    /// Whether the device has links, so that a handle pose can be computed.
    pub fn has_links(&self) -> bool {
        !self.links.is_empty()
    }
}
