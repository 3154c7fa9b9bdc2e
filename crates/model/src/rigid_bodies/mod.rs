//! The rigid bodies of a device: what its moving rows carry, as a tree whose equations of motion are those of its joints.

mod credible;
mod joints;
mod plausible;
mod segments;
mod work;

use std::fmt;

use haptical_dynamics::{Body, Inertia, Joint, Tree};
use haptical_kinematics::Pose;
use haptical_kinematics::nalgebra::{Matrix3, Vector3};

pub use crate::rigid_bodies::credible::GivenInertia;
pub use crate::rigid_bodies::plausible::RowBody;
pub use crate::rigid_bodies::segments::{Segment, SegmentBody, Segments};
pub use crate::rigid_bodies::work::MotionWork;
use crate::{Device, JointType, ModelError};

/// Gravity where a file gives none and plausible numbers are asked for \[m/s^2\]: z of frame (-1) is up.
const PLAUSIBLE_GRAVITY_MPS2: [f64; 3] = [0.0, 0.0, -9.81];

/// The moving rows of a device as rigid bodies, with gravity and the joints that drive them.
///
/// Body i is row i + 1. Its frame is the one behind the row's motion, which turns about or slides along its z axis.
/// Positions, velocities, accelerations and torques are those of the device's **joints**, one number for each,
/// counted from home as in a log \[rad\], \[m\]; torques are the drives', positive along +theta \[N m\], \[N\]. A row that
/// follows a joint, `q = multiplier (home + theta) + offset`, is taken with it: with `T = dq/dtheta`,
/// `tau = T^T tau_rows`, `M = T^T M_rows T`.
///
/// Transmission errors, compliances and effects are **not** part of it: `theta` is the joint's output, which a reading differs
/// from by its transmission error. Who wants it exact passes [`crate::Evaluation::output_rad`].
///
/// ```
/// use haptical_model::{Device, RigidBodies};
/// let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n\
///     [[link]]\na_m = 0.4\nalpha_rad = 0.0\nd_m = 0.0\nmass_kg = 2.0\ncentre_of_mass_m = [0.3, 0.0, 0.0]\n\
///     inertia_kgm2 = [0.0, 0.02, 0.02, 0.0, 0.0, 0.0]\n\
///     [[joint]]\narmature_kgm2 = 0.1\n[gravity]\nvector_mps2 = [0.0, -10.0, 0.0]\n";
/// let lever = Device::from_toml(text, "lever.toml")?.device;
/// let bodies = RigidBodies::of_device(&lever)?;
/// let (mut work, mut torque_nm) = (bodies.work(), [0.0]);
/// bodies.torques(&[0.0], &[0.0], &[3.0], &mut work, &mut torque_nm)?;
/// // weight, and acceleration of 2 kg at 0.3 m with its own inertia and the armature
/// assert!((torque_nm[0] - (6.0 + 3.0 * (0.18 + 0.02 + 0.1))).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RigidBodies {
    bodies: Vec<Body>,
    gravity_mps2: Vector3<f64>,
    /// Joint of each body, and the body's motion per the joint's.
    drives: Vec<(usize, f64)>,
    joints: usize,
    /// Whether body i moves with joint i, one for one.
    is_plain: bool,
    masses: Vec<RowMass>,
    flanges: Vec<Flange>,
    assumed: Vec<Missing>,
}

/// What one row carries, and what of it the device file says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RowMass {
    /// Row of the device, from 1.
    pub row: usize,
    /// Mass, first moment and inertia in the frame behind the row's motion.
    pub inertia: Inertia,
    /// Whether the file gives `mass_kg`.
    pub has_mass: bool,
    /// Whether the file gives `centre_of_mass_m`; one of exactly 0 counts as none, which is what is taken where the
    /// key is missing.
    pub has_centre: bool,
    /// Whether the file gives `inertia_kgm2`, and it is what is used.
    pub has_inertia: bool,
}

/// Where a hand is on the body that carries it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flange {
    /// Body, from 0; none for a hand on row 0, which stands still.
    pub body: Option<usize>,
    /// The hand's frame in the body's frame; of a hand on row 0 in that row's frame.
    pub pose: Pose,
}

/// A number that a motion depends on and that a device file does not give.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Missing {
    /// The mass of a row, and with it its centre and inertia.
    Mass {
        /// Row, from 1.
        row: usize,
    },
    /// The inertia of a row whose mass is known.
    Inertia {
        /// Row, from 1.
        row: usize,
    },
    /// An inertia that some body has: the one that is given is that of none.
    Body {
        /// Row, from 1.
        row: usize,
        /// What is wrong with it.
        why: &'static str,
    },
    /// Gravity.
    Gravity,
}

impl Missing {
    /// The row that it is about, from 1; none for gravity.
    pub fn row(&self) -> Option<usize> {
        match *self {
            Self::Mass { row } | Self::Inertia { row } | Self::Body { row, .. } => Some(row),
            Self::Gravity => None,
        }
    }

    /// Inertias of a device that no body has.
    ///
    /// # Errors
    /// As [`Segments::of_device`].
    pub fn bodies(device: &Device) -> Result<Vec<Self>, ModelError> {
        let mut missing = missing(device, &Segments::of_device(device)?);
        missing.retain(|own| matches!(own, Self::Body { .. }));
        Ok(missing)
    }
}

impl fmt::Display for Missing {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mass { row } => write!(formatter, "no mass of row {row} (`mass_kg`)"),
            Self::Inertia { row } => {
                write!(formatter, "no inertia of row {row} (`inertia_kgm2`)")
            }
            Self::Body { row, why } => write!(
                formatter,
                "an inertia of row {row} that no body has (`inertia_kgm2`: {why})"
            ),
            Self::Gravity => write!(formatter, "no gravity (`[gravity] vector_mps2`)"),
        }
    }
}

impl RigidBodies {
    /// The bodies of a device whose file gives the mass and the inertia of every moving row, and gravity. The inertia of
    /// a row whose mass is given as 0 is 0 unless stated. Joints without `armature_kgm2` have none. An inertia that no body
    /// has ([`GivenInertia`]) counts as missing.
    ///
    /// # Errors
    /// [`ModelError::Unweighed`] with all that is missing; as [`Segments::of_device`]; [`ModelError::NoRow`] for a joint
    /// that moves nothing; [`ModelError::Dynamics`] for numbers that no tree can have.
    pub fn of_device(device: &Device) -> Result<Self, ModelError> {
        let segments = Segments::of_device(device)?;
        let missing = missing(device, &segments);
        if !missing.is_empty() {
            return Err(ModelError::Unweighed {
                device: device.name.clone(),
                missing,
            });
        }
        let carried = segments.rows.iter().map(|segment| {
            let own = segment.body.as_ref();
            own.map_or_else(Inertia::default, |own| {
                let about_centre = own.inertia_kgm2.unwrap_or_else(Matrix3::zeros);
                Inertia::about_centre(own.mass_kg, &own.centre_m, &about_centre)
            })
        });
        let carried: Vec<(Inertia, bool)> = carried.map(|own| (own, false)).collect();
        Self::new(device, &segments, &carried, Vec::new())
    }

    /// The same with plausible numbers for what the file does not give, as the written robot descriptions have
    /// ([`RowBody::of_rows`], assumption A150), gravity (0, 0, -9.81) m/s^2 among them; [`RigidBodies::assumed`] says which.
    ///
    /// # Errors
    /// As [`RigidBodies::of_device`], but for [`ModelError::Unweighed`].
    pub fn plausible(device: &Device) -> Result<Self, ModelError> {
        let segments = Segments::of_device(device)?;
        let rows = RowBody::of_rows(device, &segments);
        let carried = rows.iter().map(|own| {
            let inertia = Inertia::about_centre(own.mass_kg, &own.centre_m, &own.inertia_kgm2);
            (inertia, own.plausible.is_some())
        });
        let carried: Vec<(Inertia, bool)> = carried.collect();
        let mut assumed = missing(device, &segments);
        // a point, which gets some extent
        for (index, own) in rows.iter().enumerate() {
            let row = index + 1;
            let is_said = assumed.iter().any(|other| other.row() == Some(row));
            let is_known = segments.rows[index]
                .body
                .is_some_and(|own| matches!(own.given_inertia(), GivenInertia::Body(_)));
            if own.plausible.is_some() && !is_said && !is_known {
                assumed.push(Missing::Inertia { row });
            }
        }
        Self::new(device, &segments, &carried, assumed)
    }

    /// `carried`: inertia of each row, and whether any of it is made up.
    fn new(
        device: &Device,
        segments: &Segments,
        carried: &[(Inertia, bool)],
        assumed: Vec<Missing>,
    ) -> Result<Self, ModelError> {
        let mut bodies = Vec::with_capacity(segments.rows.len());
        let mut masses = Vec::with_capacity(segments.rows.len());
        let mut drives = Vec::with_capacity(segments.rows.len());
        let mut has_row = vec![false; device.joints.len()];
        for (index, (segment, (inertia, is_made_up))) in
            segments.rows.iter().zip(carried).enumerate()
        {
            let (row, drive) = (index + 1, segment.drive);
            let joints = device.joints.len();
            let known = has_row.get_mut(drive.joint);
            let known = known.ok_or(ModelError::NoJoint {
                joint: drive.joint + 1,
                joints,
            })?;
            // a joint's armature is on the first row that it moves
            let armature = segment.armature(device).filter(|_| !*known);
            *known = true;
            bodies.push(Body {
                parent: device.parent(row).and_then(|parent| parent.checked_sub(1)),
                placement: segment.origin(device),
                joint: match drive.motion {
                    JointType::Revolute => Joint::Revolute(Vector3::z_axis()),
                    JointType::Prismatic => Joint::Prismatic(Vector3::z_axis()),
                },
                inertia: *inertia,
                armature_kgm2: armature.unwrap_or(0.0),
            });
            drives.push((drive.joint, drive.multiplier));
            masses.push(RowMass {
                row,
                inertia: *inertia,
                has_mass: segment.body.is_some(),
                has_centre: has_centre(device, row),
                has_inertia: segment.body.is_some_and(|own| own.inertia_kgm2.is_some())
                    && !is_made_up,
            });
        }
        if let Some(joint) = has_row.iter().position(|has_row| !has_row) {
            return Err(ModelError::NoRow {
                device: device.name.clone(),
                joint: joint + 1,
            });
        }
        let plain = |(index, (joint, multiplier)): (usize, &(usize, f64))| {
            *joint == index && *multiplier == 1.0
        };
        let flange = |(hand, pose): (usize, &Pose)| Flange {
            body: match device.hands.get(hand) {
                Some(hand) => hand.row.checked_sub(1),
                None => bodies.len().checked_sub(1),
            },
            pose: *pose,
        };
        let gravity_mps2 = device.gravity_mps2.unwrap_or(PLAUSIBLE_GRAVITY_MPS2);
        let all = Self {
            flanges: segments.handles.iter().enumerate().map(flange).collect(),
            joints: device.joints.len(),
            is_plain: drives.iter().enumerate().all(plain) && drives.len() == device.joints.len(),
            gravity_mps2: Vector3::from(gravity_mps2),
            bodies,
            drives,
            masses,
            assumed,
        };
        all.tree()?;
        Ok(all)
    }

    /// The bodies as a tree: positions and torques of its functions are those of the rows, `q = multiplier theta` for
    /// each body ([`RigidBodies::drive`]), home and offset being part of its placements.
    ///
    /// # Errors
    /// None that the constructor has not found.
    pub fn tree(&self) -> Result<Tree<'_>, ModelError> {
        Ok(Tree::new(&self.bodies, self.gravity_mps2)?)
    }

    /// The bodies, parents before children.
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// Joints of the device.
    pub fn joint_count(&self) -> usize {
        self.joints
    }

    /// The joint (from 0) that moves a body (from 0), and the body's motion per the joint's.
    pub fn drive(&self, body: usize) -> Option<(usize, f64)> {
        self.drives.get(body).copied()
    }

    /// What each body carries, in their order.
    pub fn masses(&self) -> &[RowMass] {
        &self.masses
    }

    /// Gravity in frame (-1) \[m/s^2\].
    pub fn gravity_mps2(&self) -> &Vector3<f64> {
        &self.gravity_mps2
    }

    /// What the device file does not give and is made up here; empty for [`RigidBodies::of_device`].
    pub fn assumed(&self) -> &[Missing] {
        &self.assumed
    }

    /// Where a hand (from 0) is: the only one, of a device without hands. What it carries is added to the body with
    /// [`Inertia::seen_from`].
    pub fn flange(&self, hand: usize) -> Option<&Flange> {
        self.flanges.get(hand)
    }

    /// The same bodies with other inertias, such as estimated ones: one for each body, in its frame. Joints keep their
    /// armatures.
    ///
    /// # Errors
    /// [`ModelError::Dynamics`] for another number of them, and for a mass below 0 or a number that is not finite.
    pub fn with_inertias(&self, inertias: &[Inertia]) -> Result<Self, ModelError> {
        if inertias.len() != self.bodies.len() {
            return Err(haptical_dynamics::DynamicsError::Length {
                buffer: "the slice of inertias",
                expected: self.bodies.len(),
                got: inertias.len(),
            }
            .into());
        }
        let mut other = self.clone();
        let bodies = other.bodies.iter_mut().zip(&mut other.masses);
        for ((body, mass), inertia) in bodies.zip(inertias) {
            body.inertia = *inertia;
            mass.inertia = *inertia;
        }
        other.tree()?;
        Ok(other)
    }
}

fn has_centre(device: &Device, row: usize) -> bool {
    let body = device.bodies.get(row).copied().flatten();
    body.is_some_and(|body| body.centre_of_mass_m != [0.0; 3])
}

/// What the device file does not give.
fn missing(device: &Device, segments: &Segments) -> Vec<Missing> {
    let rows = segments.rows.iter().enumerate();
    let rows = rows.filter_map(|(index, segment)| {
        let row = index + 1;
        let Some(own) = segment.body else {
            return Some(Missing::Mass { row });
        };
        match own.given_inertia() {
            GivenInertia::NoBody(why) => Some(Missing::Body { row, why }),
            GivenInertia::None if own.mass_kg > 0.0 => Some(Missing::Inertia { row }),
            _ => None,
        }
    });
    let gravity = device.gravity_mps2.is_none().then_some(Missing::Gravity);
    rows.chain(gravity).collect()
}
