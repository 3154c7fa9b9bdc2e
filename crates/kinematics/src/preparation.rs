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
//! What is left is a slide along x and y and one turn about x, whatever the convention, the tilt beta
//! the number of fixed rows, and the constant origins of the rows.

use nalgebra::Vector3;

use crate::chain::{Chain, POSITION_LIMIT_M};
use crate::frame::Frame;
use crate::{KinematicsError, Motion, Parameter, Pose};

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

/// What stands between a joint and the next one.
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
fn euler(frame: &Frame) -> Euler {
    // the third column is (sin phi sin alpha, -cos phi sin alpha, cos alpha)
    let z = frame.z;
    let sign = if z.y > 0.0 { -1.0 } else { 1.0 };
    // adding 0 turns -0 into 0: the angle of (0, -0) would be pi
    let phi_rad = libm::atan2(sign * z.x + 0.0, -sign * z.y + 0.0);
    let (alpha_sine, alpha_cosine) = (sign * libm::hypot(z.x, z.y), z.z);
    // Rz(-phi) times the first column is (cos psi, cos alpha sin psi, sin alpha sin psi)
    let x = turned_back(&frame.x, phi_rad);
    let psi_rad = libm::atan2(alpha_cosine * x.y + alpha_sine * x.z, x.x);
    Euler {
        phi_rad,
        alpha_sine,
        alpha_cosine,
        psi_rad,
    }
}

/// Rz(-phi) `vector`.
fn turned_back(vector: &Vector3<f64>, phi_rad: f64) -> Vector3<f64> {
    let (sine, cosine) = libm::sincos(phi_rad);
    Vector3::new(
        vector.x * cosine + vector.y * sine,
        vector.y * cosine - vector.x * sine,
        vector.z,
    )
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
    let mut joints = [JointConstants::NONE; JOINTS];
    // constant[i] is what stands behind joint i; before the first joint it is `start`
    let mut constants = [Frame::identity(); JOINTS];
    let mut start = Frame::identity();
    let mut moving = 0;
    for (row, (link, motion)) in chain.links().iter().zip(chain.motions()).enumerate() {
        if let Some(origin) = chain.origin(row) {
            behind(&mut start, &mut constants, moving).place(origin);
        }
        for parameter in chain.convention().order() {
            let frame = behind(&mut start, &mut constants, moving);
            frame.step(parameter, link.get(parameter));
            // the variable is of the same turn or slide as the parameter: it goes behind it
            if motion.variable() == Some(parameter) {
                joints[moving].row = row;
                joints[moving].is_prismatic = *motion == Motion::Prismatic;
                moving += 1;
            }
        }
    }
    if let Some(origin) = chain.origin(chain.links().len()) {
        behind(&mut start, &mut constants, moving).place(origin);
    }
    // from the end to the base, because what is passed on is passed on again
    for joint in (0..JOINTS).rev() {
        let slide_m = core::mem::take(&mut constants[joint].origin.z);
        behind(&mut start, &mut constants, joint).step(Parameter::D, slide_m);
    }
    let mut psi_rad = 0.0;
    for (joint, constant) in joints.iter_mut().zip(&constants) {
        let angles = euler(constant);
        let slide_m = turned_back(&constant.origin, angles.phi_rad);
        joint.offset_rad = psi_rad + angles.phi_rad;
        (joint.x_m, joint.y_m) = (slide_m.x, slide_m.y);
        (joint.twist_sine, joint.twist_cosine) = (angles.alpha_sine, angles.alpha_cosine);
        psi_rad = angles.psi_rad;
    }
    let (end_sine, end_cosine) = libm::sincos(psi_rad);
    Ok(ChainConstants {
        start: start.pose(),
        joints,
        end_sine,
        end_cosine,
    })
}

/// What stands behind the first `moving` joints.
fn behind<'f>(start: &'f mut Frame, constants: &'f mut [Frame], moving: usize) -> &'f mut Frame {
    match moving {
        0 => start,
        joints => &mut constants[joints - 1],
    }
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
