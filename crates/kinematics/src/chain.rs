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
    origins: &'a [Option<Pose>],
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
            origins: &[],
        })
    }

    /// Joins `links` with a constant rigid transform before rows: the chain is
    /// `O_0 A_0 O_1 A_1 ... O_n A_n O_(n+1)`, the last one carrying the last row's frame to the
    /// chain's end.
    ///
    /// `origins` has up to one entry more than there are rows; where it ends, and where an entry is
    /// `None`, there is no transform. A row behind an origin may have six numbers of 0 and still have
    /// six independent derivatives, whatever the directions of the axes: see [`Link`].
    ///
    /// ```
    /// use haptical_kinematics::{Chain, Convention, Link, Motion, Pose, nalgebra::Vector3};
    /// // A joint 0.4 m above the base, and an end 0.1 m in front of it.
    /// let at = |x, z| Some(Pose { position_m: Vector3::new(x, 0.0, z), ..Pose::default() });
    /// let origins = [at(0.0, 0.4), at(0.1, 0.0)];
    /// let (links, motions) = ([Link::default()], [Motion::Revolute]);
    /// let chain = Chain::with_origins(Convention::Standard, &links, &motions, &origins)?;
    /// let pose = chain.pose(&[core::f64::consts::FRAC_PI_2])?;
    /// assert!((pose.position_m - Vector3::new(0.0, 0.1, 0.4)).norm() < 1e-15);
    /// # Ok::<(), haptical_kinematics::KinematicsError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`Chain::new`]; [`KinematicsError::OriginCount`] for too many origins,
    /// [`KinematicsError::Origin`] for one that is not finite or whose rotation is none.
    pub fn with_origins(
        convention: Convention,
        links: &'a [Link],
        motions: &'a [Motion],
        origins: &'a [Option<Pose>],
    ) -> Result<Self, KinematicsError> {
        let chain = Self::new(convention, links, motions)?;
        if origins.len() > links.len() + 1 {
            return Err(KinematicsError::OriginCount {
                rows: links.len(),
                origins: origins.len(),
            });
        }
        for (row, origin) in origins.iter().enumerate() {
            if let Some(origin) = origin
                && !origin.is_rigid(POSITION_LIMIT_M)
            {
                return Err(KinematicsError::Origin { row });
            }
        }
        Ok(Self { origins, ..chain })
    }

    /// The constant transform before a row; of the number behind the last row, that before the end.
    pub fn origin(&self, row: usize) -> Option<&'a Pose> {
        self.origins.get(row).and_then(Option::as_ref)
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
            if let Some(origin) = self.origin(row) {
                frame.place(origin);
            }
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
            check_range(&frame, row)?;
            if *motion != Motion::Fixed {
                joint += 1;
            }
        }
        if let Some(origin) = self.origin(self.links.len()) {
            frame.place(origin);
            check_range(&frame, self.links.len() - 1)?;
        }
        Ok(frame)
    }
}

/// Refuses a frame that is too far away for its distance to be squared.
fn check_range(frame: &Frame, row: usize) -> Result<(), KinematicsError> {
    // Not `> limit`: a NaN from infinity times zero must be caught as well.
    let is_near = |coordinate: &f64| coordinate.abs() <= POSITION_LIMIT_M;
    if frame.origin.iter().all(is_near) {
        return Ok(());
    }
    Err(KinematicsError::PositionOutOfRange {
        row,
        limit_m: POSITION_LIMIT_M,
    })
}
