//! Joins rows into a chain and computes the pose of its end.

use crate::frame::Frame;
use crate::{Convention, KinematicsError, Link, Motion, Parameter, Pose};

/// Largest coordinate of a frame's origin, in m: its square, and the sums of a few such squares,
/// are still finite, so that no later step can overflow.
pub(crate) const POSITION_LIMIT_M: f64 = 1e150;

/// A serial chain: a table of links, how each row moves, and the convention that reads the table.
///
/// It borrows the table, so that an optimiser can build one per step without copying.
///
/// ```
/// use haptical_kinematics::{Chain, Convention, Link, Motion};
/// // A planar arm of two links, 0.3 m and 0.2 m, elbow at a right angle.
/// let links = [0.3, 0.2].map(|a_m| Link { a_m, ..Link::default() });
/// let chain = Chain::new(Convention::Standard, &links, &[Motion::Revolute; 2])?;
/// let pose = chain.pose(&[0.0, core::f64::consts::FRAC_PI_2])?;
/// assert!((pose.position_m.x - 0.3).abs() < 1e-15);
/// assert!((pose.position_m.y - 0.2).abs() < 1e-15);
/// # Ok::<(), haptical_kinematics::KinematicsError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Chain<'a> {
    convention: Convention,
    links: &'a [Link],
    motions: &'a [Motion],
}

impl<'a> Chain<'a> {
    /// Joins `links`, first row at frame (-1), with one motion per row.
    ///
    /// # Errors
    ///
    /// [`KinematicsError::RowCount`] if the lengths differ, [`KinematicsError::EmptyChain`] if
    /// they are 0, [`KinematicsError::NonFiniteParameter`] for the first such parameter.
    pub fn new(
        convention: Convention,
        links: &'a [Link],
        motions: &'a [Motion],
    ) -> Result<Self, KinematicsError> {
        if links.len() != motions.len() {
            return Err(KinematicsError::RowCount {
                links: links.len(),
                motions: motions.len(),
            });
        }
        if links.is_empty() {
            return Err(KinematicsError::EmptyChain);
        }
        for (row, link) in links.iter().enumerate() {
            for parameter in Parameter::ALL {
                let value = link.get(parameter);
                if !value.is_finite() {
                    return Err(KinematicsError::NonFiniteParameter {
                        row,
                        parameter,
                        value,
                    });
                }
            }
        }
        Ok(Self {
            convention,
            links,
            motions,
        })
    }

    /// The convention that reads the table.
    pub fn convention(&self) -> Convention {
        self.convention
    }

    /// The table, first row at frame (-1).
    pub fn links(&self) -> &'a [Link] {
        self.links
    }

    /// One motion per row.
    pub fn motions(&self) -> &'a [Motion] {
        self.motions
    }

    /// Number of rows whose motion is not [`Motion::Fixed`].
    pub fn joint_count(&self) -> usize {
        self.motions
            .iter()
            .filter(|motion| **motion != Motion::Fixed)
            .count()
    }

    /// Pose of the last frame in frame (-1): `A_0 A_1 ... A_n = [C P; 0 1]`.
    ///
    /// `joints` holds one value per moving row, in row order: for a revolute row an angle in rad,
    /// added to its `theta_rad`; for a prismatic row a length in m, added to its `d_m`.
    /// Source: Baser & Konukseven eqs. (3) and (4); [`Convention`] for the rows' transforms.
    ///
    /// # Errors
    ///
    /// [`KinematicsError::JointCount`]; [`KinematicsError::NonFiniteJoint`] with the number of the
    /// joint; [`KinematicsError::JointOverflow`] or [`KinematicsError::PositionOutOfRange`] for
    /// finite numbers whose sum or product is not usable.
    pub fn pose(&self, joints: &[f64]) -> Result<Pose, KinematicsError> {
        self.check_joints(joints)?;
        let end = self.walk(joints, |_, _, _, _| {})?;
        Ok(end.pose())
    }

    pub(crate) fn check_joints(&self, joints: &[f64]) -> Result<(), KinematicsError> {
        let expected = self.joint_count();
        if joints.len() != expected {
            return Err(KinematicsError::JointCount {
                expected,
                got: joints.len(),
            });
        }
        let moving = (0..self.motions.len()).filter(|row| self.motions[*row] != Motion::Fixed);
        for (joint, (row, value)) in moving.zip(joints.iter().copied()).enumerate() {
            if !value.is_finite() {
                return Err(KinematicsError::NonFiniteJoint { joint, row, value });
            }
        }
        Ok(())
    }

    /// The forward pass: visits every elementary motion from frame (-1) to the end.
    ///
    /// `visit` receives the row, the number of moving rows before it, the parameter, and the frame
    /// from which the parameter's motion starts. `joints` must have passed `check_joints`.
    pub(crate) fn walk(
        &self,
        joints: &[f64],
        mut visit: impl FnMut(usize, usize, Parameter, &Frame),
    ) -> Result<Frame, KinematicsError> {
        let mut frame = Frame::identity();
        let mut joint = 0;
        for (row, (link, motion)) in self.links.iter().zip(self.motions).enumerate() {
            let mut link = *link;
            if let Some(parameter) = motion.variable() {
                let value = joints[joint];
                let sum = link.get(parameter) + value;
                if !sum.is_finite() {
                    return Err(KinematicsError::JointOverflow {
                        joint,
                        row,
                        parameter,
                        value,
                    });
                }
                link.set(parameter, sum);
            }
            for parameter in self.convention.order() {
                visit(row, joint, parameter, &frame);
                frame.step(parameter, link.get(parameter));
            }
            // Not `> limit`: a NaN from infinity times zero must be caught as well.
            if !frame
                .origin
                .iter()
                .all(|coordinate| coordinate.abs() <= POSITION_LIMIT_M)
            {
                return Err(KinematicsError::PositionOutOfRange {
                    row,
                    limit_m: POSITION_LIMIT_M,
                });
            }
            if *motion != Motion::Fixed {
                joint += 1;
            }
        }
        Ok(frame)
    }
}
