//! The references that a device is measured against: the tracker's place, touched points and planes, a homing fixture.

use haptical_kinematics::Pose;
use haptical_kinematics::nalgebra::{Matrix3, Rotation3, Vector3};

use crate::{Device, Origin};

/// Numbers outside the chain that a calibration may have to fit with it.
///
/// Where a list is empty or an entry is `None` nothing is known yet: a calibration finds start values.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Surroundings {
    /// Frame (-1) seen from the tracker, where the tracker's base is unknown.
    pub tracker_base: Option<Placement>,
    /// What is tracked, seen from the handle frame, where the tool is unknown.
    pub tracker_tool: Option<Placement>,
    /// The same of what is tracked on each hand, where the device has several: the id is the hand's name.
    pub tools: Vec<Tool>,
    /// Standard deviation of a coordinate of a touch \[m\].
    pub contact_sd_m: Option<f64>,
    /// Touched points.
    pub contacts: Vec<ContactPoint>,
    /// Standard deviation of a touch across its plane \[m\].
    pub plane_sd_m: Option<f64>,
    /// Touched planes.
    pub planes: Vec<TouchedPlane>,
    /// Planes at a known angle.
    pub plane_pairs: Vec<PlanePair>,
    /// Standard deviation of an angle that a homing fixture holds \[rad\].
    pub fixture_sd_rad: Option<f64>,
    /// Compliance behind the external encoder, joint by joint; empty where every joint is rigid.
    pub compliance: Vec<JointCompliance>,
}

/// A thing that is tracked, by the id of what it is on.
#[derive(Debug, Clone, PartialEq)]
pub struct Tool {
    /// Name of the hand.
    pub id: String,
    /// What is tracked, seen from the hand; none until a calibration has found a start value.
    pub placement: Option<Placement>,
}

/// A rigid transform that may be fitted: a start, and a small turn before it.
///
/// The orientation is `exp([turn_rad]) R(start)`, the turn being a rotation vector in the frame that the
/// transform leads from. Near the start three such numbers have no singular arrangement.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Placement {
    /// Position, and the orientation that turns start from.
    pub start: Origin,
    /// Rotation vector from the start's orientation \[rad\].
    pub turn_rad: [f64; 3],
}

/// A point that the handle touched again and again.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactPoint {
    /// As in the log's column `contact`.
    pub id: String,
    /// Position in frame (-1) \[m\].
    pub position_m: [f64; 3],
}

/// A plane that the handle touched: all points p with `normal . p = offset_m`.
#[derive(Debug, Clone, PartialEq)]
pub struct TouchedPlane {
    /// As in the log's column `plane`.
    pub id: String,
    /// Unit normal in frame (-1) that the tilts start from.
    pub normal: [f64; 3],
    /// Tilts along the two axes of [`TouchedPlane::axes`]: the normal is the unit vector along
    /// `normal + tilt[0] u + tilt[1] w`.
    pub tilt: [f64; 2],
    /// Distance from frame (-1)'s origin along the normal \[m\].
    pub offset_m: f64,
}

/// Two planes at a known angle.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanePair {
    /// First plane.
    pub a: String,
    /// Second plane.
    pub b: String,
    /// Angle between the planes, at most a right angle \[rad\].
    pub angle_rad: f64,
    /// Its standard deviation \[rad\].
    pub sd_rad: f64,
}

/// What a joint yields behind its external encoder.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct JointCompliance {
    /// Angle per drive torque \[rad/(N m)\]; \[m/N\] for a prismatic joint.
    pub rad_per_nm: f64,
    /// Whether a calibration may fit it.
    pub fit: bool,
}

impl Placement {
    /// A placement at a pose, without a turn.
    pub fn from_pose(pose: &Pose) -> Self {
        Self {
            start: Origin::from_pose(pose),
            turn_rad: [0.0; 3],
        }
    }

    /// The transform as position and rotation matrix.
    ///
    /// ```
    /// use haptical_model::{Origin, Placement};
    /// let turned = Placement { start: Origin::IDENTITY, turn_rad: [0.0, 0.0, std::f64::consts::FRAC_PI_2] };
    /// // a quarter turn about z takes x to y
    /// assert!((turned.pose().rotation[(1, 0)] - 1.0).abs() < 1e-15);
    /// ```
    pub fn pose(&self) -> Pose {
        let start = self.start.pose();
        if self.turn_rad == [0.0; 3] {
            return start;
        }
        let turn = Rotation3::new(Vector3::from(self.turn_rad)).into_inner();
        Pose {
            position_m: start.position_m,
            rotation: turn * start.rotation,
        }
    }

    /// Rotation vector by which the orientation turns per unit of each component of the turn: the columns
    /// of the left Jacobian of SO(3) (Chirikjian 2012, section 10.6).
    pub fn turn_axes(&self) -> Matrix3<f64> {
        let turn = Vector3::from(self.turn_rad);
        let angle = turn.norm();
        let cross = turn.cross_matrix();
        let (first, second) = if angle < 1e-4 {
            // series: the closed forms lose all digits near zero
            let square = angle * angle;
            (0.5 - square / 24.0, 1.0 / 6.0 - square / 120.0)
        } else {
            let square = angle * angle;
            let (sin, cos) = angle.sin_cos();
            ((1.0 - cos) / square, (angle - sin) / (square * angle))
        };
        Matrix3::identity() + cross * first + cross * cross * second
    }

    /// The same transform without a turn: what a file holds.
    #[must_use]
    pub fn settled(&self) -> Self {
        if self.turn_rad == [0.0; 3] {
            return *self;
        }
        Self {
            start: Origin {
                // the position stays bit by bit
                position_m: self.start.position_m,
                ..Origin::from_pose(&self.pose())
            },
            turn_rad: [0.0; 3],
        }
    }
}

impl Tool {
    /// The same without a turn: what a file holds.
    #[must_use]
    pub fn settled(&self) -> Self {
        Self {
            placement: self.placement.map(|placement| placement.settled()),
            ..self.clone()
        }
    }
}

impl TouchedPlane {
    /// Two unit vectors across the start normal and across each other.
    pub fn axes(&self) -> [Vector3<f64>; 2] {
        let normal = Vector3::from(self.normal);
        // the coordinate axis that is farthest from the normal
        let least = normal.iamin();
        let mut other = Vector3::zeros();
        other[least] = 1.0;
        let first = normal.cross(&other);
        let first = first / first.norm();
        [first, normal.cross(&first)]
    }

    /// Unit normal, and its derivatives with respect to the two tilts.
    ///
    /// With m = n0 + t1 u + t2 w: n = m / |m|, dn/dt1 = (u - n (n . u)) / |m|.
    pub fn normal_and_slopes(&self) -> (Vector3<f64>, [Vector3<f64>; 2]) {
        let axes = self.axes();
        let sum = Vector3::from(self.normal) + axes[0] * self.tilt[0] + axes[1] * self.tilt[1];
        let length = sum.norm();
        let normal = sum / length;
        let slope = |axis: &Vector3<f64>| (axis - normal * normal.dot(axis)) / length;
        (normal, axes.each_ref().map(slope))
    }

    /// The same plane without tilts: what a file holds.
    #[must_use]
    pub fn settled(&self) -> Self {
        if self.tilt == [0.0; 2] {
            return self.clone();
        }
        Self {
            normal: self.normal_and_slopes().0.into(),
            tilt: [0.0; 2],
            ..self.clone()
        }
    }
}

impl Surroundings {
    /// The same numbers as a file holds them: turns and tilts put into what they start from.
    #[must_use]
    pub fn settled(&self) -> Self {
        Self {
            tracker_base: self.tracker_base.map(|placement| placement.settled()),
            tracker_tool: self.tracker_tool.map(|placement| placement.settled()),
            tools: self.tools.iter().map(Tool::settled).collect(),
            planes: self.planes.iter().map(TouchedPlane::settled).collect(),
            ..self.clone()
        }
    }

    /// Position of a tool within [`Surroundings::tools`].
    pub fn tool_index(&self, id: &str) -> Option<usize> {
        self.tools.iter().position(|tool| tool.id == id)
    }

    /// Position of a contact within [`Surroundings::contacts`].
    pub fn contact_index(&self, id: &str) -> Option<usize> {
        self.contacts.iter().position(|contact| contact.id == id)
    }

    /// Position of a plane within [`Surroundings::planes`].
    pub fn plane_index(&self, id: &str) -> Option<usize> {
        self.planes.iter().position(|plane| plane.id == id)
    }
}

impl Device {
    /// Compliance of a joint (from 0) behind its external encoder \[rad/(N m)\]; 0 for a rigid one.
    pub fn compliance_rad_per_nm(&self, joint: usize) -> f64 {
        let compliance = self.surroundings.compliance.get(joint);
        compliance.map_or(0.0, |compliance| compliance.rad_per_nm)
    }

    /// Lets a calibration fit what every joint yields behind its external encoder, as `fit = ["compliance"]` of
    /// each `[[joint]]` does.
    ///
    /// ```
    /// use haptical_model::Device;
    /// let mut device = Device::from_toml("[[joint]]\n[[joint]]\n", "two.toml")?.device;
    /// device.fit_compliance();
    /// assert_eq!(device.further_parameters().len(), 2);
    /// # Ok::<(), haptical_model::DeviceFileError>(())
    /// ```
    pub fn fit_compliance(&mut self) {
        let compliance = &mut self.surroundings.compliance;
        compliance.resize(self.joints.len(), JointCompliance::default());
        for joint in compliance {
            joint.fit = true;
        }
    }

    /// Whether a joint yields to its torque, or may be found to.
    pub fn has_compliance(&self) -> bool {
        let mut compliance = self.surroundings.compliance.iter();
        compliance.any(|joint| joint.fit || joint.rad_per_nm != 0.0)
    }
}
