//! Differentiates the pose of a chain's end with respect to every parameter and every joint.

use crate::chain::Chain;
use crate::frame::complete_turn;
use crate::{Convention, KinematicsError, Motion, Parameter, Pose, Twist};

/// Derivatives of the end pose with respect to the six parameters of one row.
///
/// The frames and units are those of [`Twist`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinkDerivatives {
    /// With respect to `a_m`.
    pub a: Twist,
    /// With respect to `alpha_rad`.
    pub alpha: Twist,
    /// With respect to `d_m`.
    pub d: Twist,
    /// With respect to `theta_rad`.
    pub theta: Twist,
    /// With respect to `beta_rad`.
    pub beta: Twist,
    /// With respect to `b_m`.
    pub b: Twist,
}

impl LinkDerivatives {
    /// The derivative with respect to one parameter.
    pub const fn get(&self, parameter: Parameter) -> Twist {
        match parameter {
            Parameter::A => self.a,
            Parameter::Alpha => self.alpha,
            Parameter::D => self.d,
            Parameter::Theta => self.theta,
            Parameter::Beta => self.beta,
            Parameter::B => self.b,
        }
    }

    /// The derivative with respect to the row's joint variable; `None` for a fixed row.
    ///
    /// The joint variable is added to `theta` or `d`, so its derivative is that parameter's.
    pub fn joint(&self, motion: Motion) -> Option<Twist> {
        motion.variable().map(|parameter| self.get(parameter))
    }

    fn get_mut(&mut self, parameter: Parameter) -> &mut Twist {
        match parameter {
            Parameter::A => &mut self.a,
            Parameter::Alpha => &mut self.alpha,
            Parameter::D => &mut self.d,
            Parameter::Theta => &mut self.theta,
            Parameter::Beta => &mut self.beta,
            Parameter::B => &mut self.b,
        }
    }
}

impl Chain<'_> {
    /// Pose of the last frame, and its derivatives with respect to all parameters of all rows.
    ///
    /// `out` has one entry per row; `joints` is as in [`Chain::pose`]. For a turn about the axis
    /// `w` through `p`: `linear = w x (P - p)`, `angular = w`; for a slide along `w`:
    /// `linear = w`, `angular = 0`. The crate's first page derives this. One sine and one cosine
    /// per turn, no allocation.
    ///
    /// ```
    /// use haptical_kinematics::{Chain, Convention, Link, LinkDerivatives, Motion};
    /// let links = [Link { a_m: 0.3, d_m: 0.1, ..Link::default() }];
    /// let chain = Chain::new(Convention::Standard, &links, &[Motion::Revolute])?;
    /// let mut out = [LinkDerivatives::default()];
    /// chain.derivatives(&[0.0], &mut out)?;
    /// // P = (a cos theta, a sin theta, d)
    /// assert_eq!(out[0].a.linear.as_slice(), [1.0, 0.0, 0.0]);
    /// assert_eq!(out[0].theta.linear.as_slice(), [0.0, 0.3, 0.0]);
    /// assert_eq!(out[0].d.linear.as_slice(), [0.0, 0.0, 1.0]);
    /// # Ok::<(), haptical_kinematics::KinematicsError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`KinematicsError::BufferLength`] if `out` has not one entry per row, otherwise as
    /// [`Chain::pose`]. After an overflow error the entries of `out` have no meaning.
    pub fn derivatives(
        &self,
        joints: &[f64],
        out: &mut [LinkDerivatives],
    ) -> Result<Pose, KinematicsError> {
        check_length(
            "the slice of link derivatives",
            self.links().len(),
            out.len(),
        )?;
        self.check_joints(joints)?;
        let end = self.walk(joints, |row, _, parameter, frame| {
            *out[row].get_mut(parameter) = frame.screw(parameter);
        })?;
        for row in out.iter_mut() {
            complete_turn(&mut row.alpha, &end.origin);
            complete_turn(&mut row.theta, &end.origin);
            complete_turn(&mut row.beta, &end.origin);
        }
        Ok(end.pose())
    }

    /// Pose of the last frame, and its geometric Jacobian: one column per moving row.
    ///
    /// Column `j` is `[z x (P - p); z]` for a revolute joint (m/rad; rad/rad) and `[z; 0]` for a
    /// prismatic one (m/m; rad/m), `z` being the joint's axis and `p` a point of it, so that
    /// `[v; omega] = J qdot` is the velocity of the last frame's origin and the angular velocity
    /// of the last frame, both expressed in frame (-1).
    /// Source: Siciliano et al., *Robotics: Modelling, Planning and Control*, section 3.1.
    ///
    /// # Errors
    ///
    /// [`KinematicsError::BufferLength`] if `out` has not one entry per moving row, otherwise as
    /// [`Chain::pose`]. After an overflow error the entries of `out` have no meaning.
    pub fn geometric_jacobian(
        &self,
        joints: &[f64],
        out: &mut [Twist],
    ) -> Result<Pose, KinematicsError> {
        check_length(
            "the slice of Jacobian columns",
            self.joint_count(),
            out.len(),
        )?;
        self.check_joints(joints)?;
        let end = self.walk(joints, |row, joint, parameter, frame| {
            if self.motions()[row].variable() == Some(parameter) {
                out[joint] = frame.screw(parameter);
            }
        })?;
        let moving = self
            .motions()
            .iter()
            .filter(|motion| **motion != Motion::Fixed);
        for (column, motion) in out.iter_mut().zip(moving) {
            if *motion == Motion::Revolute {
                complete_turn(column, &end.origin);
            }
        }
        Ok(end.pose())
    }

    /// Pose of the last frame, with the frame behind each row's turn about z and the screw of each moving row, in one pass:
    /// what the weights of all rows need.
    ///
    /// `frames` has one entry per row; `screws` one per moving row: `[p; z]` of a revolute joint, `p` a point of its axis
    /// `z`, and `[z; 0]` of a prismatic one, in frame (-1).
    ///
    /// ```
    /// use haptical_kinematics::{Chain, Convention, Link, Motion, Pose, Twist};
    /// let links = [0.3, 0.2].map(|a_m| Link { a_m, ..Link::default() });
    /// let chain = Chain::new(Convention::Standard, &links, &[Motion::Revolute; 2])?;
    /// let (mut frames, mut screws) = ([Pose::default(); 2], [Twist::default(); 2]);
    /// let end = chain.turned_frames(&[0.0, 0.0], &mut frames, &mut screws)?;
    /// // the second joint is where the first row ends, the handle another 0.2 m off
    /// assert_eq!((frames[1].position_m.x, screws[1].linear.x, end.position_m.x), (0.3, 0.3, 0.5));
    /// assert_eq!(screws[1].angular.z, 1.0);
    /// # Ok::<(), haptical_kinematics::KinematicsError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`KinematicsError::BufferLength`] for slices of other lengths, otherwise as [`Chain::pose`]. After an overflow
    /// error the entries have no meaning.
    pub fn turned_frames(
        &self,
        joints: &[f64],
        frames: &mut [Pose],
        screws: &mut [Twist],
    ) -> Result<Pose, KinematicsError> {
        let (rows, moving) = (self.links().len(), self.joint_count());
        check_length("the slice of frames", rows, frames.len())?;
        check_length("the slice of screws", moving, screws.len())?;
        self.check_joints(joints)?;
        // what follows the turn about z
        let behind = match self.convention() {
            Convention::Standard => Parameter::A,
            Convention::Modified => Parameter::D,
        };
        let end = self.walk(joints, |row, joint, parameter, frame| {
            if parameter == behind {
                frames[row] = frame.pose();
            }
            if self.motions()[row].variable() == Some(parameter) {
                screws[joint] = frame.screw(parameter);
            }
        })?;
        Ok(end.pose())
    }
}

pub(crate) fn check_length(
    buffer: &'static str,
    expected: usize,
    got: usize,
) -> Result<(), KinematicsError> {
    if got == expected {
        Ok(())
    } else {
        Err(KinematicsError::BufferLength {
            buffer,
            expected,
            got,
        })
    }
}
