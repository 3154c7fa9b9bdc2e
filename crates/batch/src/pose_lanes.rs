//! Poses and Jacobians of many postures of a chain, some postures at a time in lanes.

mod walk;

use haptical_kinematics::nalgebra::{Matrix3, Vector3};
use haptical_kinematics::{Chain, ChainConstants, KinematicsError, Pose, PreparedChain, Twist};
use pulp::{Arch, Simd, WithSimd};

use crate::BatchError;
use crate::error::check_length;
use crate::poses::not_finite;
use crate::trigonometry::LARGEST_RAD;
use haptical_linalg::Aligned;

use walk::{BLOCK, COLUMN, POSE, TILE, turns, walk};

/// Poses and geometric Jacobians of many postures of a chain with `JOINTS` moving rows.
///
/// The numbers are those of [`Chain::geometric_jacobian`] but for rounding: lengths of order 1 m agree to
/// 1e-14, plus the spacing of numbers of the joint variables' size. A posture's numbers do not depend on
/// the postures next to it; on machines with and without fused multiply-add they differ by rounding.
///
/// ```
/// use haptical_batch::PoseLanes;
/// use haptical_kinematics::{Chain, Convention, Link, Motion};
/// // A planar arm of two links, 0.3 m and 0.2 m: stretched, and with the elbow at a right angle.
/// let links = [0.3, 0.2].map(|a_m| Link { a_m, ..Link::default() });
/// let chain = Chain::new(Convention::Standard, &links, &[Motion::Revolute; 2])?;
/// let mut lanes = PoseLanes::<2>::new(&chain)?;
/// lanes.evaluate(&[[0.0, 0.0], [0.0, std::f64::consts::FRAC_PI_2]])?;
/// let (stretched, bent) = (lanes.pose(0).unwrap(), lanes.pose(1).unwrap());
/// assert!((stretched.position_m.x - 0.5).abs() < 1e-15);
/// assert!((bent.position_m.y - 0.2).abs() < 1e-15);
/// let jacobian = lanes.jacobian(1).unwrap();
/// assert!((jacobian[1].linear.x + 0.2).abs() < 1e-15); // turning the elbow moves the end along -x
/// # Ok::<(), haptical_batch::BatchError>(())
/// ```
#[derive(Debug)]
pub struct PoseLanes<const JOINTS: usize> {
    chain: PreparedChain<JOINTS>,
    postures: usize,
    numbers: Aligned,
    room: Room,
}

/// A tile's joint variables, sines and cosines, joint by joint.
#[derive(Debug)]
struct Room {
    variables: Aligned,
    sines: Aligned,
    cosines: Aligned,
}

impl<const JOINTS: usize> PoseLanes<JOINTS> {
    /// Numbers of one posture: 12 of the pose, 6 of each column.
    pub const NUMBERS: usize = POSE + COLUMN * JOINTS;

    /// Prepares a chain; there are no postures yet.
    ///
    /// # Errors
    /// [`BatchError::Chain`] if the chain has not `JOINTS` moving rows, or lengths beyond its limit.
    pub fn new(chain: &Chain<'_>) -> Result<Self, BatchError> {
        Ok(Self {
            chain: PreparedChain::new(chain)?,
            postures: 0,
            numbers: Aligned::default(),
            room: Room {
                variables: Aligned::zeros(JOINTS * TILE),
                sines: Aligned::zeros(JOINTS * TILE),
                cosines: Aligned::zeros(JOINTS * TILE),
            },
        })
    }

    /// Works out every posture; allocates only if there are more of them than ever before.
    ///
    /// `joints` has one slice per joint, in rad or m, with one entry per posture.
    /// Source: Siciliano et al., *Robotics: Modelling, Planning and Control*, section 3.1.
    ///
    /// # Errors
    /// [`BatchError::Length`] if the slices' lengths differ; [`BatchError::Pose`] for a joint variable
    /// that is not finite, or a length of more than 1e150 m. There are no postures then.
    pub fn evaluate<J: AsRef<[f64]>>(&mut self, joints: &[J; JOINTS]) -> Result<(), BatchError> {
        self.postures = 0;
        let postures = joints.first().map_or(0, |joint| joint.as_ref().len());
        for joint in joints {
            check_length("a joint's variables", postures, joint.as_ref().len())?;
        }
        let slices: [&[f64]; JOINTS] = std::array::from_fn(|joint| joints[joint].as_ref());
        self.numbers
            .reserve(postures.next_multiple_of(TILE) * Self::NUMBERS);
        Arch::new().dispatch(Evaluate {
            chain: &self.chain,
            joints: &slices,
            postures,
            room: Tile {
                variables: self.room.variables.as_mut_slice(),
                sines: self.room.sines.as_mut_slice(),
                cosines: self.room.cosines.as_mut_slice(),
            },
            numbers: self.numbers.as_mut_slice(),
        })?;
        self.postures = postures;
        Ok(())
    }

    /// Number of postures of the last evaluation.
    pub fn len(&self) -> usize {
        self.postures
    }

    /// Whether nothing has been evaluated.
    pub fn is_empty(&self) -> bool {
        self.postures == 0
    }

    /// The numbers, blocks of 8 postures one after the other: number k of the posture 8 b + i, i < 8, is
    /// entry `8 * (NUMBERS * b + k) + i`.
    ///
    /// The numbers of a posture are position \[m\], the axes x, y, z of its rotation, then for each joint
    /// linear and angular part of the column, all in frame (-1). The last block is filled up with
    /// postures that mean nothing.
    pub fn blocks(&self) -> &[f64] {
        &self.numbers.as_slice()[..self.postures.next_multiple_of(BLOCK) * Self::NUMBERS]
    }

    /// A posture's pose; none beyond the last posture.
    pub fn pose(&self, posture: usize) -> Option<Pose> {
        (posture < self.postures).then(|| Pose {
            position_m: self.vector(posture, 0),
            rotation: Matrix3::from_columns(&[3, 6, 9].map(|number| self.vector(posture, number))),
        })
    }

    /// A posture's Jacobian, one column per moving row; none beyond the last posture.
    pub fn jacobian(&self, posture: usize) -> Option<[Twist; JOINTS]> {
        (posture < self.postures).then(|| {
            std::array::from_fn(|joint| Twist {
                linear: self.vector(posture, POSE + COLUMN * joint),
                angular: self.vector(posture, POSE + COLUMN * joint + 3),
            })
        })
    }

    fn vector(&self, posture: usize, number: usize) -> Vector3<f64> {
        let at = entry::<JOINTS>(posture, number);
        let numbers = &self.numbers.as_slice()[at..];
        Vector3::new(numbers[0], numbers[BLOCK], numbers[2 * BLOCK])
    }
}

/// Where a number of a posture is.
fn entry<const JOINTS: usize>(posture: usize, number: usize) -> usize {
    let block = PoseLanes::<JOINTS>::NUMBERS * (posture / BLOCK);
    BLOCK * (block + number) + posture % BLOCK
}

/// The room of a tile as slices.
struct Tile<'a> {
    variables: &'a mut [f64],
    sines: &'a mut [f64],
    cosines: &'a mut [f64],
}

struct Evaluate<'a, const JOINTS: usize> {
    chain: &'a PreparedChain<JOINTS>,
    joints: &'a [&'a [f64]; JOINTS],
    postures: usize,
    room: Tile<'a>,
    numbers: &'a mut [f64],
}

impl<const JOINTS: usize> WithSimd for Evaluate<'_, JOINTS> {
    type Output = Result<(), BatchError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let block_numbers = BLOCK * PoseLanes::<JOINTS>::NUMBERS;
        let constants = self.chain.constants();
        let Tile {
            variables,
            sines,
            cosines,
        } = self.room;
        for first in (0..self.postures).step_by(TILE) {
            let postures = TILE.min(self.postures - first);
            let mut are_served = true;
            for (index, slice) in self.joints.iter().enumerate() {
                let own = &mut variables[index * TILE..][..TILE];
                own[..postures].copy_from_slice(&slice[first..][..postures]);
                own[postures..].fill(0.0);
            }
            if !turns(simd, constants, variables, sines, cosines) {
                are_served = false;
                hide_far(self.joints, first, postures, variables);
                turns(simd, constants, variables, sines, cosines);
            }
            for block in (0..postures).step_by(BLOCK) {
                let at = (first + block) / BLOCK * block_numbers;
                let numbers = &mut self.numbers[at..][..block_numbers];
                walk(
                    simd,
                    constants,
                    [&*variables, &*sines, &*cosines],
                    block,
                    numbers,
                );
            }
            if !are_served {
                let last = first + postures;
                far::<JOINTS>(self.chain, self.joints, first..last, self.numbers)?;
            }
        }
        Ok(())
    }
}

/// Whether the lanes do not serve a posture.
fn is_far<const JOINTS: usize>(joints: &[&[f64]; JOINTS], posture: usize) -> bool {
    !joints
        .iter()
        .all(|joint| joint[posture].abs() <= LARGEST_RAD)
}

/// Replaces the variables of postures that the lanes do not serve by 0.
#[cold]
fn hide_far<const JOINTS: usize>(
    joints: &[&[f64]; JOINTS],
    first: usize,
    postures: usize,
    variables: &mut [f64],
) {
    for posture in (0..postures).filter(|posture| is_far(joints, first + posture)) {
        for variables in variables.chunks_mut(TILE) {
            variables[posture] = 0.0;
        }
    }
}

/// Works out the postures that the lanes do not serve, one by one.
#[cold]
fn far<const JOINTS: usize>(
    chain: &PreparedChain<JOINTS>,
    joints: &[&[f64]; JOINTS],
    postures: std::ops::Range<usize>,
    numbers: &mut [f64],
) -> Result<(), BatchError> {
    for posture in postures.filter(|posture| is_far(joints, *posture)) {
        let variables: [f64; JOINTS] = std::array::from_fn(|joint| joints[joint][posture]);
        let mut jacobian = [Twist::default(); JOINTS];
        let pose = chain
            .pose_and_jacobian(&variables, &mut jacobian)
            .map_err(|error| refusal(chain.constants(), &variables, posture, error))?;
        let columns = pose.position_m.iter().chain(pose.rotation.iter());
        let twists = jacobian
            .iter()
            .flat_map(|column| column.linear.iter().chain(column.angular.iter()));
        for (number, value) in columns.chain(twists).enumerate() {
            numbers[entry::<JOINTS>(posture, number)] = *value;
        }
    }
    Ok(())
}

/// The chain's refusal with the number of the posture.
fn refusal<const JOINTS: usize>(
    constants: &ChainConstants<JOINTS>,
    variables: &[f64; JOINTS],
    posture: usize,
    error: KinematicsError,
) -> BatchError {
    match error {
        KinematicsError::NonFiniteJoint { value, .. } => {
            not_finite("a joint variable", posture, value)
        }
        KinematicsError::PositionOutOfRange { row, .. } => {
            let joint = constants.joints.iter().position(|joint| joint.row == row);
            BatchError::Pose {
                what: "a prismatic joint's variable",
                pose: posture,
                value: joint.map_or(f64::NAN, |joint| variables[joint]),
                allowed: "at most 1e150 m",
            }
        }
        other => BatchError::Chain(other),
    }
}
