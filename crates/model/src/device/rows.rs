//! Additions to the six numbers of a row: a constant origin before it, and the joint that drives it.

use haptical_kinematics::nalgebra::{Quaternion, Rotation3, UnitQuaternion, Vector3};
use haptical_kinematics::{Link, Motion, Pose};

use crate::{Device, JointType};

/// A constant rigid transform, as a device file has it. Not calibrated.
///
/// ```
/// use haptical_model::Origin;
/// let half = std::f64::consts::FRAC_1_SQRT_2;
/// let origin = Origin { position_m: [0.0, 0.0, 0.3], orientation_wxyz: [half, half, 0.0, 0.0] };
/// // a quarter turn about x takes y to z
/// assert!((origin.pose().rotation[(2, 1)] - 1.0).abs() < 1e-15);
/// let again = Origin::from_pose(&origin.pose());
/// assert!((again.orientation_wxyz[1] - half).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Origin {
    /// Position \[m\].
    pub position_m: [f64; 3],
    /// Orientation as a unit quaternion w, x, y, z.
    pub orientation_wxyz: [f64; 4],
}

impl Default for Origin {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Origin {
    /// No displacement and no turn.
    pub const IDENTITY: Self = Self {
        position_m: [0.0; 3],
        orientation_wxyz: [1.0, 0.0, 0.0, 0.0],
    };

    /// The transform as position and rotation matrix; the quaternion is normalised.
    pub fn pose(&self) -> Pose {
        let [w, x, y, z] = self.orientation_wxyz;
        let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        Pose {
            position_m: Vector3::from(self.position_m),
            rotation: turn.to_rotation_matrix().into_inner(),
        }
    }

    /// The transform of a position and a rotation matrix.
    pub fn from_pose(pose: &Pose) -> Self {
        let turn = Rotation3::from_matrix_unchecked(pose.rotation);
        let turn = UnitQuaternion::from_rotation_matrix(&turn);
        Self {
            position_m: pose.position_m.into(),
            orientation_wxyz: [turn.w, turn.i, turn.j, turn.k],
        }
    }
}

/// Which joint moves a row: the row's variable is `multiplier (home + output) + offset`, in the unit of
/// the row's own motion. A row of its own joint has the multiplier 1 and the offset 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Joint, from 0.
    pub joint: usize,
    /// Whether the row turns or slides.
    pub motion: JointType,
    /// Row variable per joint variable.
    pub multiplier: f64,
    /// Row variable where the joint variable is 0, \[rad\], or \[m\] for a row that slides.
    pub offset: f64,
}

impl JointType {
    /// Unit of its variable: `rad` or `m`.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Revolute => "rad",
            Self::Prismatic => "m",
        }
    }

    /// The kinematics' word for it.
    pub fn motion(self) -> Motion {
        match self {
            Self::Revolute => Motion::Revolute,
            Self::Prismatic => Motion::Prismatic,
        }
    }
}

impl Device {
    /// What moves a row; `None` for row 0 and for a row that the device does not have.
    pub fn drive(&self, row: usize) -> Option<Drive> {
        let index = row.checked_sub(1)?;
        if !self.drives.is_empty() {
            return self.drives.get(index).copied();
        }
        let joint = self.joints.get(index)?;
        Some(Drive {
            joint: index,
            motion: joint.joint_type,
            multiplier: 1.0,
            offset: 0.0,
        })
    }

    /// First row that a joint (from 0) moves; `None` for a joint that the device does not have.
    pub fn first_row(&self, joint: usize) -> Option<usize> {
        if self.drives.is_empty() {
            return (joint < self.joints.len()).then_some(joint + 1);
        }
        let row = self.drives.iter().position(|drive| drive.joint == joint);
        row.map(|index| index + 1)
    }

    /// The row whose variable is a joint's own (joint from 0): the first that it drives with the multiplier 1 and its own
    /// motion, or the first that it drives at all. None for a joint that drives no row.
    pub fn own_row(&self, joint: usize) -> Option<usize> {
        let first = self.first_row(joint)?;
        let motion = self.joints.get(joint)?.joint_type;
        let is_own = |row: &usize| {
            let drive = self.drive(*row);
            drive.is_some_and(|drive| {
                drive.joint == joint && drive.multiplier == 1.0 && drive.motion == motion
            })
        };
        (first..self.links.len()).find(is_own).or(Some(first))
    }

    /// Whether row i moves with joint i, one for one, for all rows: no row follows another's joint.
    pub fn drives_are_plain(&self) -> bool {
        self.drives.is_empty()
    }

    /// Whether a row has an origin before it, so that all six of its numbers may be identified.
    pub fn is_general_row(&self, row: usize) -> bool {
        row < self.links.len() && self.origins.get(row).is_some_and(Option::is_some)
    }

    /// Whether the chain is its table alone: no origins, no rows that follow another's joint, no branches, no slide
    /// along y, no joint that yields. What knows nothing of these asks first.
    pub fn is_plain_table(&self) -> bool {
        self.origins.iter().all(Option::is_none)
            && !self.has_hands()
            && self.drives_are_plain()
            && self.links.iter().all(|link| link.b_m == 0.0)
            && !self.has_compliance()
    }

    /// What each row's variable does: row 0 is fixed, row i moves with the joint that drives it.
    pub fn motions(&self) -> Vec<Motion> {
        if self.drives.is_empty() {
            let own = self.joints.iter().map(|joint| joint.joint_type.motion());
            return std::iter::once(Motion::Fixed).chain(own).collect();
        }
        let driven = self.drives.iter().map(|drive| drive.motion.motion());
        std::iter::once(Motion::Fixed).chain(driven).collect()
    }

    /// The rows as the chain wants them: what the home pose adds is in `theta_rad` or `d_m`.
    pub fn chain_links(&self) -> Vec<Link> {
        let mut links = self.links.clone();
        for (row, link) in links.iter_mut().enumerate() {
            let Some(drive) = self.drive(row) else {
                continue;
            };
            let home = self.joints.get(drive.joint).map_or(0.0, |own| own.home_rad);
            let constant = drive.multiplier * home + drive.offset;
            match drive.motion {
                JointType::Prismatic => link.d_m += constant,
                JointType::Revolute => link.theta_rad += constant,
            }
        }
        links
    }

    /// The constant transforms as the chain wants them; empty where there are none.
    pub fn chain_origins(&self) -> Vec<Option<Pose>> {
        self.origins
            .iter()
            .map(|origin| origin.as_ref().map(Origin::pose))
            .collect()
    }
}
