//! A chain made ready for pose and Jacobian in the least time.

use nalgebra::{Matrix3, Vector3};
use wide::f64x4;

use crate::chain::POSITION_LIMIT_M;
use crate::preparation::prepare;
use crate::sines::sines_cosines;
use crate::trigonometry::LARGEST_RAD;
use crate::{Chain, ChainConstants, KinematicsError, Pose, Twist};

/// A chain of `JOINTS` moving rows whose constants are worked out once.
///
/// [`Chain::geometric_jacobian`] works out six elementary motions a row at every call; here a joint
/// costs one turn about z, one slide and one turn about x, and the sines of all joints are worked out
/// together. The numbers are those of the chain but for rounding: lengths of order 1 m agree to 1e-14,
/// plus the spacing of numbers of the joint variables' size. They are the same on every machine.
///
/// ```
/// use haptical_kinematics::{Chain, Convention, Link, Motion, PreparedChain, Twist};
/// // A planar arm of two links, 0.3 m and 0.2 m, elbow at a right angle.
/// let links = [0.3, 0.2].map(|a_m| Link { a_m, ..Link::default() });
/// let chain = Chain::new(Convention::Standard, &links, &[Motion::Revolute; 2])?;
/// let prepared = PreparedChain::<2>::new(&chain)?;
/// let mut jacobian = [Twist::default(); 2];
/// let pose = prepared.pose_and_jacobian(&[0.0, core::f64::consts::FRAC_PI_2], &mut jacobian)?;
/// assert!((pose.position_m.x - 0.3).abs() < 1e-15);
/// assert!((pose.position_m.y - 0.2).abs() < 1e-15);
/// // turning the elbow moves the end along -x, turning the base also along y
/// assert!((jacobian[1].linear.x + 0.2).abs() < 1e-15);
/// assert!((jacobian[0].linear.y - 0.3).abs() < 1e-15);
/// # Ok::<(), haptical_kinematics::KinematicsError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreparedChain<const JOINTS: usize> {
    constants: ChainConstants<JOINTS>,
    start: Walker,
    /// Slides and twists behind the joints, one number in all lanes each.
    behind: [Behind; JOINTS],
    end: [f64x4; 2],
    offsets_rad: [f64; JOINTS],
    has_prismatic: bool,
}

/// A frame's axes and origin in frame (-1), coordinates in lanes; the fourth lane is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Walker {
    x: f64x4,
    y: f64x4,
    z: f64x4,
    origin: f64x4,
}

impl Walker {
    #[inline(always)]
    fn pose(&self) -> Pose {
        Pose {
            position_m: vector(self.origin),
            rotation: Matrix3::from_columns(&[vector(self.x), vector(self.y), vector(self.z)]),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Behind {
    x_m: f64x4,
    y_m: f64x4,
    sine: f64x4,
    cosine: f64x4,
}

/// Turns two axes in their plane, the first towards the second.
#[inline(always)]
fn turn(first: &mut f64x4, second: &mut f64x4, sine: f64x4, cosine: f64x4) {
    let turned = *first * cosine + *second * sine;
    *second = *second * cosine - *first * sine;
    *first = turned;
}

const fn lanes([x, y, z]: [f64; 3]) -> f64x4 {
    f64x4::new([x, y, z, 0.0])
}

#[inline(always)]
fn vector(lanes: f64x4) -> Vector3<f64> {
    let [x, y, z, _] = lanes.to_array();
    Vector3::new(x, y, z)
}

impl<const JOINTS: usize> PreparedChain<JOINTS> {
    /// Prepares a chain.
    ///
    /// # Errors
    ///
    /// [`KinematicsError::JointCount`] if the chain has not `JOINTS` moving rows;
    /// [`KinematicsError::PositionOutOfRange`] if the sum of its lengths' magnitudes is beyond the limit.
    pub fn new(chain: &Chain<'_>) -> Result<Self, KinematicsError> {
        prepare(chain).map(Self::from_constants)
    }

    /// A chain of constants as [`Preparation`](crate::Preparation) finishes them; usable in a constant.
    pub const fn from_constants(constants: ChainConstants<JOINTS>) -> Self {
        let [x, y, z] = constants.start.rotation.data.0;
        let [origin] = constants.start.position_m.data.0;
        let zero = f64x4::splat(0.0);
        let mut prepared = Self {
            start: Walker {
                x: lanes(x),
                y: lanes(y),
                z: lanes(z),
                origin: lanes(origin),
            },
            behind: [Behind {
                x_m: zero,
                y_m: zero,
                sine: zero,
                cosine: zero,
            }; JOINTS],
            end: [
                f64x4::splat(constants.end_sine),
                f64x4::splat(constants.end_cosine),
            ],
            offsets_rad: [0.0; JOINTS],
            has_prismatic: false,
            constants,
        };
        let mut index = 0;
        while index < JOINTS {
            let joint = &constants.joints[index];
            prepared.behind[index] = Behind {
                x_m: f64x4::splat(joint.x_m),
                y_m: f64x4::splat(joint.y_m),
                sine: f64x4::splat(joint.twist_sine),
                cosine: f64x4::splat(joint.twist_cosine),
            };
            prepared.offsets_rad[index] = joint.offset_rad;
            prepared.has_prismatic |= joint.is_prismatic;
            index += 1;
        }
        prepared
    }

    /// What is left of the chain: the same motions, fewer of them.
    pub const fn constants(&self) -> &ChainConstants<JOINTS> {
        &self.constants
    }

    /// Pose of the last frame, and its geometric Jacobian, one column per moving row.
    ///
    /// `joints` in rad or m, pose and columns are those of [`Chain::geometric_jacobian`]: column j is
    /// `[z x (P - p); z]` for a revolute joint and `[z; 0]` for a prismatic one.
    /// Source: Siciliano et al., *Robotics: Modelling, Planning and Control*, section 3.1.
    ///
    /// # Errors
    ///
    /// [`KinematicsError::NonFiniteJoint`] with the number of the joint;
    /// [`KinematicsError::PositionOutOfRange`] for a length beyond the limit. `out` is then unchanged.
    pub fn pose_and_jacobian(
        &self,
        joints: &[f64; JOINTS],
        out: &mut [Twist; JOINTS],
    ) -> Result<Pose, KinematicsError> {
        // written so that a NaN is not served; no early end, so that the comparisons are made together
        let is_served = joints
            .iter()
            .fold(true, |served, joint| served & (joint.abs() <= LARGEST_RAD));
        if !is_served {
            return self.far(joints, out);
        }
        Ok(self.pose_and_jacobian_in_range(joints, out))
    }

    /// As [`Self::pose_and_jacobian`], for joint variables of at most
    /// [`LARGEST_RAD`](crate::trigonometry::LARGEST_RAD) in size, which the caller has checked: fixed work and
    /// no panic. Beyond that size the numbers have no meaning.
    #[inline]
    pub fn pose_and_jacobian_in_range(
        &self,
        joints: &[f64; JOINTS],
        out: &mut [Twist; JOINTS],
    ) -> Pose {
        self.visited(joints, out, |_, _| {})
    }

    /// As [`Self::pose_and_jacobian_in_range`], with the frame behind each joint: where the chain is after the joint's
    /// turn or slide, the slides and the twist behind it ([`ChainConstants`]). A point that the link behind the joint
    /// carries has constant coordinates in it.
    #[inline]
    pub fn pose_jacobian_and_frames_in_range(
        &self,
        joints: &[f64; JOINTS],
        out: &mut [Twist; JOINTS],
        frames: &mut [Pose; JOINTS],
    ) -> Pose {
        self.visited(joints, out, |joint, walker| {
            if let Some(frame) = frames.get_mut(joint) {
                *frame = walker.pose();
            }
        })
    }

    #[inline(always)]
    fn visited(
        &self,
        joints: &[f64; JOINTS],
        out: &mut [Twist; JOINTS],
        visit: impl FnMut(usize, &Walker),
    ) -> Pose {
        if self.has_prismatic {
            let angles_rad = core::array::from_fn(|joint| {
                let variable = if self.constants.joints[joint].is_prismatic {
                    0.0
                } else {
                    joints[joint]
                };
                self.offsets_rad[joint] + variable
            });
            let (sines, cosines) = sines_cosines(&angles_rad);
            return self.walk::<true>(joints, &sines, &cosines, out, visit);
        }
        let angles_rad = core::array::from_fn(|joint| self.offsets_rad[joint] + joints[joint]);
        let (sines, cosines) = sines_cosines(&angles_rad);
        self.walk::<false>(joints, &sines, &cosines, out, visit)
    }

    /// As [`Self::pose_and_jacobian`], for joint variables of any size.
    #[cold]
    #[inline(never)]
    fn far(
        &self,
        joints: &[f64; JOINTS],
        out: &mut [Twist; JOINTS],
    ) -> Result<Pose, KinematicsError> {
        let (mut sines, mut cosines) = ([0.0; JOINTS], [0.0; JOINTS]);
        for (joint, (&value, constants)) in joints.iter().zip(&self.constants.joints).enumerate() {
            let row = constants.row;
            if !value.is_finite() {
                return Err(KinematicsError::NonFiniteJoint { joint, row, value });
            }
            let (sine, cosine) = libm::sincos(constants.offset_rad);
            (sines[joint], cosines[joint]) = if !constants.is_prismatic {
                // not the sine of the sum, whose rounding would lose the digits of the offset
                let (own_sine, own_cosine) = libm::sincos(value);
                (
                    own_sine * cosine + own_cosine * sine,
                    own_cosine * cosine - own_sine * sine,
                )
            } else if value.abs() <= POSITION_LIMIT_M {
                (sine, cosine)
            } else {
                let limit_m = POSITION_LIMIT_M;
                return Err(KinematicsError::PositionOutOfRange { row, limit_m });
            };
        }
        Ok(self.walk::<true>(joints, &sines, &cosines, out, |_, _| {}))
    }

    /// The walk along the chain; a chain without prismatic joints needs no `SLIDES`.
    #[inline(always)]
    fn walk<const SLIDES: bool>(
        &self,
        joints: &[f64; JOINTS],
        sines: &[f64; JOINTS],
        cosines: &[f64; JOINTS],
        out: &mut [Twist; JOINTS],
        mut visit: impl FnMut(usize, &Walker),
    ) -> Pose {
        let Walker {
            mut x,
            mut y,
            mut z,
            mut origin,
        } = self.start;
        let mut axes = [f64x4::splat(0.0); JOINTS];
        let mut points = [f64x4::splat(0.0); JOINTS];
        for joint in 0..JOINTS {
            (axes[joint], points[joint]) = (z, origin);
            if SLIDES && self.constants.joints[joint].is_prismatic {
                origin += z * f64x4::splat(joints[joint]);
            }
            let (sine, cosine) = (f64x4::splat(sines[joint]), f64x4::splat(cosines[joint]));
            turn(&mut x, &mut y, sine, cosine);
            let behind = &self.behind[joint];
            origin = origin + x * behind.x_m + y * behind.y_m;
            turn(&mut y, &mut z, behind.sine, behind.cosine);
            visit(joint, &Walker { x, y, z, origin });
        }
        let [end_sine, end_cosine] = self.end;
        turn(&mut x, &mut y, end_sine, end_cosine);
        for joint in 0..JOINTS {
            let axis = vector(axes[joint]);
            out[joint] = if SLIDES && self.constants.joints[joint].is_prismatic {
                Twist {
                    linear: axis,
                    angular: Vector3::zeros(),
                }
            } else {
                Twist {
                    linear: axis.cross(&vector(origin - points[joint])),
                    angular: axis,
                }
            };
        }
        Walker { x, y, z, origin }.pose()
    }
}
