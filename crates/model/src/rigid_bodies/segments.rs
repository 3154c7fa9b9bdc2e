//! A device's chain as joints along z with constant transforms between them, whatever its convention.

use haptical_dynamics::Inertia;
use haptical_kinematics::nalgebra::{Matrix3, Vector3};
use haptical_kinematics::{Chain, Convention, Link, Motion, Pose};

use super::credible::GivenInertia;
use crate::device::Body;
use crate::rigid::{about_z, then, turn};
use crate::{Device, Drive, JointType, ModelError};

/// Share of the largest entry of a vector up to which another is rounding.
const ROUNDING: f64 = 1e-13;

/// A moving row: everything constant before its motion, and what is known of its mass.
#[derive(Debug, Clone)]
pub struct Segment {
    /// From the frame behind the motion of the row that it hangs on (from frame (-1) for the first) to this row's.
    pub before: Pose,
    /// What moves it: a turn about z, or a slide along z.
    pub drive: Drive,
    /// What it carries; none where the device file gives no mass.
    pub body: Option<SegmentBody>,
}

/// What a row carries, in the frame behind its motion.
#[derive(Debug, Clone, Copy)]
pub struct SegmentBody {
    /// Mass \[kg\].
    pub mass_kg: f64,
    /// Centre of mass \[m\].
    pub centre_m: Vector3<f64>,
    /// Inertia about the centre of mass \[kg m^2\].
    pub inertia_kgm2: Option<Matrix3<f64>>,
}

impl SegmentBody {
    /// What is to be made of its inertia.
    pub fn given_inertia(&self) -> GivenInertia {
        GivenInertia::new(self.inertia_kgm2.as_ref())
    }
}

impl Segment {
    /// Origin of the joint in a robot description whose values count from where the joint reads 0: what home
    /// and the drive's offset move is constant, and so belongs to the origin.
    pub fn origin(&self, device: &Device) -> Pose {
        let joint = device.joints.get(self.drive.joint);
        let home = joint.map_or(0.0, |joint| joint.home_rad);
        let moved = self.drive.multiplier * home + self.drive.offset;
        let moved = match self.drive.motion {
            JointType::Revolute => turn(about_z(moved)),
            JointType::Prismatic => Pose {
                position_m: Vector3::z() * moved,
                ..Pose::default()
            },
        };
        then(&self.before, &moved)
    }

    /// The largest torque of the row's drive \[N m\], \[N\], where the row moves with its joint's own drive.
    pub fn torque_limit(&self, device: &Device) -> Option<f64> {
        let limit = device.joints.get(self.drive.joint)?.torque_limit_nm?;
        Some(limit / self.drive.multiplier.abs())
    }

    /// The armature of the row's drive, seen at the row \[kg m^2\], \[kg\], where the row moves with its joint's own drive.
    pub fn armature(&self, device: &Device) -> Option<f64> {
        let armature = device.joints.get(self.drive.joint)?.armature_kgm2?;
        Some(armature / (self.drive.multiplier * self.drive.multiplier))
    }

    /// The joint's limits in a description of such values; infinite where it has none.
    pub fn limits(&self, device: &Device) -> [f64; 2] {
        let joint = device.joints.get(self.drive.joint);
        let [lower, upper] = joint.map_or([f64::NEG_INFINITY, f64::INFINITY], |joint| {
            [joint.lower_rad, joint.upper_rad]
        });
        let ends = [lower, upper].map(|end| self.drive.multiplier * end);
        [ends[0].min(ends[1]), ends[0].max(ends[1])]
    }
}

/// All of it. The motion of a row is its joint's variable, home included: offsets are constants.
#[derive(Debug, Clone)]
pub struct Segments {
    /// Rows 1 to n of the device.
    pub rows: Vec<Segment>,
    /// From the frame behind the last motion of each hand's chain to the hand.
    pub handles: Vec<Pose>,
}

impl Segments {
    /// Takes a device apart.
    ///
    /// ```
    /// use haptical_model::{Device, Segments};
    /// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
    /// let device = Device::load(path.as_ref())?.device;
    /// assert_eq!(Segments::of_device(&device)?.rows.len(), 7);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::NoLinks`]; [`ModelError::NoDrive`] for a row behind row 0 that no joint drives.
    pub fn of_device(device: &Device) -> Result<Self, ModelError> {
        of_device(device)
    }

    /// The row (from 0) that another one follows, and by which multiplier; none for a joint's own row.
    pub fn followed(&self, device: &Device, row: usize) -> Option<(usize, f64)> {
        let drive = &self.rows[row].drive;
        let source = device.own_row(drive.joint)? - 1;
        let multiplier = drive.multiplier / self.rows[source].drive.multiplier;
        (source != row).then_some((source, multiplier))
    }
}

/// A row's constant parts before and behind its motion. Rz(theta) changes places with Rz(variable) and T(0, 0, variable): it is
/// before the motion, so that what the row carries turns with the joint's zero.
fn parts(convention: Convention, link: &Link) -> Result<[Pose; 2], ModelError> {
    let turn = Link {
        theta_rad: link.theta_rad,
        ..Link::default()
    };
    let rest = Link {
        theta_rad: 0.0,
        ..*link
    };
    let pose = |link| Chain::new(convention, &[link], &[Motion::Fixed])?.pose(&[]);
    Ok(match convention {
        Convention::Standard => [pose(turn)?, pose(rest)?],
        Convention::Modified => {
            let across = Link { d_m: 0.0, ..rest };
            let along = Link {
                d_m: rest.d_m,
                ..Link::default()
            };
            [then(&pose(across)?, &pose(turn)?), pose(along)?]
        }
    })
}

fn of_device(device: &Device) -> Result<Segments, ModelError> {
    if !device.has_links() {
        return Err(ModelError::NoLinks {
            device: device.name.clone(),
        });
    }
    let origins = device.chain_origins();
    let origin = |row: usize| origins.get(row).copied().flatten().unwrap_or_default();
    let mut rows = Vec::new();
    // from the frame behind each row's motion to the end of the row
    let mut behind: Vec<Pose> = Vec::with_capacity(device.links.len());
    for (row, link) in device.links.iter().enumerate() {
        let [own_before, own_behind] = parts(device.convention, link)?;
        let parent = device.parent(row).and_then(|parent| behind.get(parent));
        let before = then(&parent.copied().unwrap_or_default(), &origin(row));
        let before = then(&before, &own_before);
        let Some(drive) = device.drive(row) else {
            if row > 0 {
                return Err(ModelError::NoDrive {
                    device: device.name.clone(),
                    row,
                });
            }
            behind.push(then(&before, &own_behind));
            continue;
        };
        let body = device.bodies.get(row).copied().flatten();
        let body = body.map(|body| SegmentBody {
            mass_kg: body.mass_kg,
            centre_m: Vector3::from(body.centre_of_mass_m),
            inertia_kgm2: body.inertia_kgm2.map(symmetric),
        });
        rows.push(Segment {
            before,
            drive,
            body,
        });
        behind.push(own_behind);
    }
    let last = |hand: usize| {
        device
            .hands
            .get(hand)
            .map_or(device.links.len() - 1, |hand| hand.row)
    };
    let handle = |hand: usize| {
        let own = device.handle_of(hand).unwrap_or_default();
        then(&behind[last(hand)], &own)
    };
    let handles = (0..device.hands.len().max(1)).map(handle).collect();
    Ok(Segments { rows, handles })
}

impl Device {
    /// Gives a moving row another mass, centre and inertia, which are those of [`crate::RowMass`]: in the frame behind the row's
    /// motion.
    ///
    /// ```
    /// use haptical_model::{Device, RigidBodies};
    /// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
    /// let mut device = Device::load(path.as_ref())?.device;
    /// let mut inertia = RigidBodies::plausible(&device)?.masses()[2].inertia;
    /// inertia.mass_kg += 1.0;
    /// device.set_row_inertia(3, &inertia)?;
    /// let again = RigidBodies::plausible(&device)?.masses()[2].inertia;
    /// assert!((again.mass_kg - inertia.mass_kg).abs() < 1e-15);
    /// assert!((again.first_moment_kgm - inertia.first_moment_kgm).norm() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::NoDrive`] for a row that does not move.
    pub fn set_row_inertia(&mut self, row: usize, inertia: &Inertia) -> Result<(), ModelError> {
        let missing = || ModelError::NoDrive {
            device: self.name.clone(),
            row,
        };
        if row == 0 || row >= self.links.len() {
            return Err(missing());
        }
        let centre_m = inertia.centre_of_mass_m().unwrap_or_default();
        let own = inertia.about_centre_kgm2();
        let body = Body {
            mass_kg: inertia.mass_kg,
            centre_of_mass_m: without_rounding(centre_m.into()),
            inertia_kgm2: Some(without_rounding(
                [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|place| own[place]),
            )),
        };
        let rows = self.links.len();
        self.bodies.resize(rows, None);
        self.bodies[row] = Some(body);
        Ok(())
    }
}

/// Entries that moves between frames leave beside the largest by rounding are 0: on another processor they would have other digits.
fn without_rounding<const N: usize>(numbers: [f64; N]) -> [f64; N] {
    let largest = numbers
        .iter()
        .fold(0.0, |most: f64, number| most.max(number.abs()));
    numbers.map(|number| match number.abs() <= ROUNDING * largest {
        true => 0.0,
        false => number,
    })
}

/// An inertia xx, yy, zz, xy, xz, yz as a matrix.
fn symmetric([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> Matrix3<f64> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}
