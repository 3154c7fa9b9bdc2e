//! Folds everything of a chain that does not move into one constant transform between two joints.
//!
//! The chain is K_0 J_1 K_1 J_2 ... J_n K_n with J a turn about or a slide along z and K the rows'
//! constant motions between two joints. A turn about z and a slide along z may change places with J,
//! which takes two of the six freedoms out of every K behind a joint:
//!
//! - K's rotation is Rz(phi) Rx(alpha) Rz(psi) (Euler's angles; Craig, *Introduction to Robotics*,
//!   appendix B). phi goes to the joint before K and psi to the joint behind it. For alpha near 0 only
//!   phi + psi is determined; any pair of the right sum serves, so no case is singular.
//! - K's slide along z goes to the other side of the joint before it.
//!
//! The rest is a slide along x and y and one turn about x, whatever the convention, the tilt beta
//! the number of fixed rows, and the constant origins of the rows.

use nalgebra::Vector3;

use crate::chain::{Chain, POSITION_LIMIT_M};
use crate::frame::Frame;
use crate::trigonometry::{LARGEST_RAD, arctangent2, constant_square_root, sine_cosine};
use crate::{Convention, KinematicsError, Link, Motion, Parameter, Pose};

/// A chain without what does not move: see [`PreparedChain::constants`](crate::PreparedChain::constants).
///
/// The pose of the end is that of the frame which starts at `start` and for each joint in turn
///
/// 1. turns about its z by `offset_rad`, for a revolute joint plus the joint variable; for a prismatic
///    joint it slides along its z by the joint variable;
/// 2. slides along its x by `x_m` and along its y by `y_m`;
/// 3. turns about its x by the twist;
///
/// and at last turns about its z by the end's angle. The joint's axis is z before these steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChainConstants<const JOINTS: usize> {
    /// Frame of the first joint in frame (-1).
    pub start: Pose,
    /// One entry per moving row, in row order.
    pub joints: [JointConstants; JOINTS],
    /// Sine of the end's angle.
    pub end_sine: f64,
    /// Cosine of the end's angle.
    pub end_cosine: f64,
}

impl<const JOINTS: usize> ChainConstants<JOINTS> {
    /// Coordinates of a point \[m\] that the link behind the first `joints` joints carries, in the frame there (the one in
    /// which the next joint moves), from where it is in frame (-1) when all joint variables are 0. Usable in a constant.
    ///
    /// ```
    /// use haptical_kinematics::{Convention, Link, Motion, Preparation};
    /// let arm = Link { a_m: 0.3, ..Link::IDENTITY };
    /// let rows = Preparation::<1>::EMPTY.row(Convention::Standard, &arm, Motion::Revolute);
    /// let local_m = rows.finish().local_m(1, [0.5, 0.1, 0.0]);
    /// assert!((local_m[0] - 0.2).abs() < 1e-15 && (local_m[1] - 0.1).abs() < 1e-15);
    /// ```
    pub const fn local_m(&self, joints: usize, point_m: [f64; 3]) -> [f64; 3] {
        let [mut origin] = self.start.position_m.data.0;
        let [mut x, mut y, mut z] = self.start.rotation.data.0;
        let mut index = 0;
        while index < joints && index < JOINTS {
            let joint = &self.joints[index];
            let (sine, cosine) = sine_cosine(joint.offset_rad);
            [x, y] = turned(x, y, sine, cosine);
            origin = sum(sum(origin, 1.0, x, joint.x_m), 1.0, y, joint.y_m);
            [y, z] = turned(y, z, joint.twist_sine, joint.twist_cosine);
            index += 1;
        }
        let [a, b, c] = sum(point_m, 1.0, origin, -1.0);
        [
            x[0] * a + x[1] * b + x[2] * c,
            y[0] * a + y[1] * b + y[2] * c,
            z[0] * a + z[1] * b + z[2] * c,
        ]
    }
}

const fn sum([a, b, c]: [f64; 3], s: f64, [d, e, f]: [f64; 3], t: f64) -> [f64; 3] {
    [a * s + d * t, b * s + e * t, c * s + f * t]
}

/// Two axes turned in their plane, the first towards the second.
const fn turned(first: [f64; 3], second: [f64; 3], sine: f64, cosine: f64) -> [[f64; 3]; 2] {
    [
        sum(first, cosine, second, sine),
        sum(second, cosine, first, -sine),
    ]
}

/// The transform between a joint and the next one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointConstants {
    /// Row of the table to which the joint belongs, counted from 0.
    pub row: usize,
    /// Whether the joint variable is a length along z, in m, instead of an angle about z, in rad.
    pub is_prismatic: bool,
    /// Angle about z besides the joint variable.
    pub offset_rad: f64,
    /// Length along x after the turn.
    pub x_m: f64,
    /// Length along y after the turn.
    pub y_m: f64,
    /// Sine of the twist about x.
    pub twist_sine: f64,
    /// Cosine of the twist about x.
    pub twist_cosine: f64,
}

impl JointConstants {
    const NONE: Self = Self {
        row: 0,
        is_prismatic: false,
        offset_rad: 0.0,
        x_m: 0.0,
        y_m: 0.0,
        twist_sine: 0.0,
        twist_cosine: 1.0,
    };
}

/// A rotation as Rz(phi) Rx(alpha) Rz(psi).
struct Euler {
    phi_rad: f64,
    alpha_sine: f64,
    alpha_cosine: f64,
    psi_rad: f64,
}

/// The angles of a frame's rotation, phi in [-pi/2, pi/2]: where the rows need no phi, it is 0.
const fn euler(frame: &Frame) -> Euler {
    // the third column is (sin phi sin alpha, -cos phi sin alpha, cos alpha)
    let [[x, y, alpha_cosine]] = frame.z.data.0;
    let sign = if y > 0.0 { -1.0 } else { 1.0 };
    let sine = constant_square_root(x * x + y * y);
    let phi_rad = if sine == 0.0 {
        0.0
    } else {
        arctangent2(sign * x, (-sign * y).abs())
    };
    let alpha_sine = sign * sine;
    // Rz(-phi) times the first column is (cos psi, cos alpha sin psi, sin alpha sin psi)
    let [x, y, z] = turned_back(&frame.x, phi_rad);
    Euler {
        phi_rad,
        alpha_sine,
        alpha_cosine,
        psi_rad: arctangent2(alpha_cosine * y + alpha_sine * z, x),
    }
}

/// Rz(-phi) `vector`.
const fn turned_back(vector: &Vector3<f64>, phi_rad: f64) -> [f64; 3] {
    let ([[x, y, z]], (sine, cosine)) = (vector.data.0, sine_cosine(phi_rad));
    [x * cosine + y * sine, y * cosine - x * sine, z]
}

/// The rows of a chain with at most `JOINTS` moving rows, taken one after the other, usable in a constant.
///
/// ```
/// use haptical_kinematics::{Convention, Link, Motion, PreparedChain, Preparation, Twist};
/// static ARM: PreparedChain<1> = {
///     let link = Link { a_m: 0.3, ..Link::IDENTITY };
///     let rows = Preparation::<1>::EMPTY.row(Convention::Standard, &link, Motion::Revolute);
///     PreparedChain::from_constants(rows.finish())
/// };
/// let mut jacobian = [Twist::default()];
/// let pose = ARM.pose_and_jacobian(&[0.5], &mut jacobian)?;
/// assert!((pose.position_m.y - 0.3 * 0.5f64.sin()).abs() < 1e-15);
/// # Ok::<(), haptical_kinematics::KinematicsError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Preparation<const JOINTS: usize> {
    start: Frame,
    /// The transform behind each joint.
    constants: [Frame; JOINTS],
    joints: [JointConstants; JOINTS],
    rows: usize,
    moving: usize,
}

impl<const JOINTS: usize> Preparation<JOINTS> {
    /// A chain without rows.
    pub const EMPTY: Self = Self {
        start: Frame::identity(),
        constants: [Frame::identity(); JOINTS],
        joints: [JointConstants::NONE; JOINTS],
        rows: 0,
        moving: 0,
    };

    /// Goes on by a constant rigid transform.
    #[must_use]
    pub const fn origin(mut self, constant: &Pose) -> Self {
        self.behind(self.moving).place(constant);
        self
    }

    /// Goes on by a row, whose angles are at most [`LARGEST_RAD`](crate::trigonometry::LARGEST_RAD) and
    /// whose lengths are finite.
    ///
    /// # Panics
    ///
    /// If more rows move than there are joints.
    #[must_use]
    pub const fn row(mut self, convention: Convention, link: &Link, motion: Motion) -> Self {
        let order = convention.order();
        let mut index = 0;
        while index < order.len() {
            let parameter = order[index];
            let frame = self.behind(self.moving);
            frame.constant_step(parameter, link.get(parameter));
            // the variable is of the same turn or slide as the parameter: it goes behind it
            let is_prismatic = matches!(motion, Motion::Prismatic);
            let moves = match parameter {
                Parameter::Theta => matches!(motion, Motion::Revolute),
                Parameter::D => is_prismatic,
                _ => false,
            };
            if moves {
                self.joints[self.moving].row = self.rows;
                self.joints[self.moving].is_prismatic = is_prismatic;
                self.moving += 1;
            }
            index += 1;
        }
        self.rows += 1;
        self
    }

    /// What is left of the chain; joints for which there were no rows stay without motion.
    pub const fn finish(mut self) -> ChainConstants<JOINTS> {
        // from the end to the base, because what is passed on is passed on again
        let mut joint = self.moving;
        while joint > 0 {
            joint -= 1;
            let [[x, y, slide_m]] = self.constants[joint].origin.data.0;
            self.constants[joint].origin = Vector3::new(x, y, 0.0);
            self.behind(joint).constant_step(Parameter::D, slide_m);
        }
        let mut psi_rad = 0.0;
        while joint < self.moving {
            let constant = &self.constants[joint];
            let angles = euler(constant);
            let [x_m, y_m, _] = turned_back(&constant.origin, angles.phi_rad);
            self.joints[joint] = JointConstants {
                offset_rad: psi_rad + angles.phi_rad,
                x_m,
                y_m,
                twist_sine: angles.alpha_sine,
                twist_cosine: angles.alpha_cosine,
                ..self.joints[joint]
            };
            psi_rad = angles.psi_rad;
            joint += 1;
        }
        let (end_sine, end_cosine) = sine_cosine(psi_rad);
        ChainConstants {
            start: self.start.pose(),
            joints: self.joints,
            end_sine,
            end_cosine,
        }
    }

    /// The transforms behind the first `moving` joints.
    const fn behind(&mut self, moving: usize) -> &mut Frame {
        match moving {
            0 => &mut self.start,
            joints => &mut self.constants[joints - 1],
        }
    }
}

/// Works out the constants of a chain with `JOINTS` moving rows.
pub(crate) fn prepare<const JOINTS: usize>(
    chain: &Chain<'_>,
) -> Result<ChainConstants<JOINTS>, KinematicsError> {
    if chain.joint_count() != JOINTS {
        return Err(KinematicsError::JointCount {
            expected: chain.joint_count(),
            got: JOINTS,
        });
    }
    check_reach(chain)?;
    let mut rows = Preparation::EMPTY;
    for (row, (link, motion)) in chain.links().iter().zip(chain.motions()).enumerate() {
        if let Some(origin) = chain.origin(row) {
            rows = rows.origin(origin);
        }
        rows = rows.row(chain.convention(), &within_range(link), *motion);
    }
    if let Some(origin) = chain.origin(chain.links().len()) {
        rows = rows.origin(origin);
    }
    Ok(rows.finish())
}

/// The row with angles that the sines serve.
fn within_range(link: &Link) -> Link {
    let mut link = *link;
    for angle_rad in [&mut link.alpha_rad, &mut link.theta_rad, &mut link.beta_rad] {
        if angle_rad.abs() > LARGEST_RAD {
            let (sine, cosine) = libm::sincos(*angle_rad);
            *angle_rad = libm::atan2(sine, cosine);
        }
    }
    link
}

/// Refuses lengths whose sum leaves the range of positions: then no posture can leave it.
fn check_reach(chain: &Chain<'_>) -> Result<(), KinematicsError> {
    let mut reach_m = 0.0;
    for (row, link) in chain.links().iter().enumerate() {
        reach_m += link.a_m.abs() + link.b_m.abs() + link.d_m.abs();
        let behind_last = usize::from(row + 1 == chain.links().len());
        for origin in (row..=row + behind_last).filter_map(|row| chain.origin(row)) {
            let length_m = |coordinate: &f64| coordinate.abs();
            reach_m += origin.position_m.iter().map(length_m).sum::<f64>();
        }
        if reach_m > POSITION_LIMIT_M {
            return Err(KinematicsError::PositionOutOfRange {
                row,
                limit_m: POSITION_LIMIT_M,
            });
        }
    }
    Ok(())
}
