//! The model itself: made once from a device, usable as a constant, then stepped in a loop.

use haptical_kinematics::{Convention, Link, Pose, PreparedChain, Twist};

use crate::device::prepared_chain;
use crate::error::{DeviceError, attempt};
use crate::limits::Limits;
use crate::transmission::Transmissions;
use crate::{GeneralRow, Joint, Motion, RuntimeError, State};

/// A calibrated device of `JOINTS` joints, ready for a control loop.
///
/// Home angles, offsets, twists and tilts are worked out beforehand, by [`PreparedChain`]: they cost nothing
/// per step, whichever the convention.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Model<const JOINTS: usize> {
    pub(crate) transmissions: Transmissions<JOINTS>,
    pub(crate) chain: PreparedChain<JOINTS>,
    pub(crate) limits: Limits<JOINTS>,
}

impl<const JOINTS: usize> Model<JOINTS> {
    /// Prepares a device: `base` is row 0, which carries frame (-1) to the base, `rows` are those of
    /// the joints. Usable in a constant: `haptical export --format rust` writes one.
    ///
    /// Source: Baser & Konukseven eqs. (3), (4); docs/equations.md, Chain derivatives and Modified convention.
    ///
    /// # Errors
    /// [`DeviceError`] names the row or joint, the key and what is allowed.
    ///
    /// ```
    /// use haptical_runtime::{Convention, Joint, Link, Model, Motion, Transmission};
    /// let rows = [0.3, 0.2].map(|a_m| Link { a_m, ..Link::IDENTITY });
    /// let joint = Joint { motion: Motion::Revolute, home: 0.0, transmission: Transmission::Exact };
    /// let model = Model::new(Convention::Standard, Link::IDENTITY, rows, [joint; 2])?;
    /// let state = model.step(&[0.0, core::f64::consts::FRAC_PI_2])?;
    /// assert!((state.pose.position_m.x - 0.3).abs() < 1e-15);
    /// assert!((state.pose.position_m.y - 0.2).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub const fn new(
        convention: Convention,
        base: Link,
        rows: [Link; JOINTS],
        joints: [Joint; JOINTS],
    ) -> Result<Self, DeviceError> {
        let mut general = [GeneralRow::IDENTITY; JOINTS];
        let mut index = 0;
        while index < JOINTS {
            general[index].link = rows[index];
            index += 1;
        }
        let base = GeneralRow {
            link: base,
            ..GeneralRow::IDENTITY
        };
        Self::general(convention, base, general, None, joints)
    }

    /// As [`Model::new`], for rows with a slide along y and with constant transforms before them;
    /// `handle` carries the last row's frame to the handle.
    ///
    /// # Errors
    /// As [`Model::new`]; [`DeviceError::Origin`].
    ///
    /// ```
    /// use haptical_runtime::{Convention, GeneralRow, Joint, Model, Motion, Pose, Transmission};
    /// // A joint 0.4 m above the base, and a handle 0.1 m in front of it.
    /// let at = |x, z| Some(Pose { position_m: [x, 0.0, z].into(), ..Pose::default() });
    /// let row = GeneralRow { origin: at(0.0, 0.4), ..GeneralRow::IDENTITY };
    /// let joint = Joint { motion: Motion::Revolute, home: 0.0, transmission: Transmission::Exact };
    /// let base = GeneralRow::IDENTITY;
    /// let model = Model::general(Convention::Standard, base, [row], at(0.1, 0.0), [joint])?;
    /// let position_m = model.step(&[core::f64::consts::FRAC_PI_2])?.pose.position_m;
    /// assert!((position_m.y - 0.1).abs() < 1e-15);
    /// assert_eq!(position_m.z, 0.4);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub const fn general(
        convention: Convention,
        base: GeneralRow,
        rows: [GeneralRow; JOINTS],
        handle: Option<Pose>,
        joints: [Joint; JOINTS],
    ) -> Result<Self, DeviceError> {
        let mut moves = [(Motion::Revolute, 0.0); JOINTS];
        let mut index = 0;
        while index < JOINTS {
            moves[index] = (joints[index].motion, joints[index].home);
            index += 1;
        }
        let chain = attempt!(prepared_chain(convention, &base, &rows, &handle, &moves));
        Ok(Self {
            transmissions: attempt!(Transmissions::new(&joints)),
            chain,
            limits: Limits::NONE,
        })
    }

    /// Readings within which the model holds, lowest and highest of each joint, \[rad\] or \[m\].
    ///
    /// For a polynomial this is the range it was fitted on; otherwise a size of 1e6 over the ratio. A
    /// parallelogram may refuse readings within: its loop must be closed.
    #[must_use]
    pub const fn ranges(&self) -> [[f64; 2]; JOINTS] {
        self.transmissions.ranges
    }

    /// The same device with joint limits, lowest and highest reading of each joint, \[rad\] or \[m\]; an infinite one is
    /// none. They are those of the device file, and change no step: see [`check_limits`](Self::check_limits). Usable in
    /// a constant.
    ///
    /// # Errors
    /// [`DeviceError::Joint`] where a lower limit is not below the upper one.
    pub const fn with_limits(mut self, limits: [[f64; 2]; JOINTS]) -> Result<Self, DeviceError> {
        self.limits = attempt!(Limits::new(limits));
        Ok(self)
    }

    /// Joint limits, lowest and highest reading of each joint, \[rad\] or \[m\]; infinite where there is none.
    #[must_use]
    pub const fn limits(&self) -> [[f64; 2]; JOINTS] {
        self.limits.0
    }

    /// Whether all readings lie within the joint limits. A step does not ask: beyond a limit the model may hold, and a
    /// controller needs the pose there to come back.
    ///
    /// # Errors
    /// [`RuntimeError::BeyondLimit`] or [`RuntimeError::NonFiniteReading`] for the first joint.
    ///
    /// ```
    /// use haptical_runtime::{Convention, Joint, Link, Model, Motion, RuntimeError, Transmission};
    /// let arm = Link { a_m: 0.3, ..Link::IDENTITY };
    /// let joint = Joint { motion: Motion::Revolute, home: 0.0, transmission: Transmission::Exact };
    /// let model = Model::new(Convention::Standard, Link::IDENTITY, [arm], [joint])?;
    /// let model = model.with_limits([[-1.0, 1.5]])?;
    /// assert!(model.check_limits(&[1.5]).is_ok());
    /// let beyond = RuntimeError::BeyondLimit { joint: 1, reading: 1.6, lower: -1.0, upper: 1.5 };
    /// assert_eq!(model.check_limits(&[1.6]), Err(beyond));
    /// assert!(model.step(&[1.6]).is_ok());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn check_limits(&self, readings: &[f64; JOINTS]) -> Result<(), RuntimeError> {
        self.limits.check(readings)
    }

    /// The device's state at `readings`: motor-side encoder angles over the nominal ratios,
    /// \[rad\], or \[m\] for a prismatic joint.
    ///
    /// The joint value is reading + error(reading), Baser & Konukseven eqs. (1) and (2), the pose
    /// eqs. (3) and (4), the Jacobian's column of a revolute joint `z x (P - p)`, `z`, that of a
    /// prismatic joint `z`, 0 (Siciliano et al., section on the geometric Jacobian).
    ///
    /// # Errors
    /// [`RuntimeError`] for the first joint whose reading is not finite or not within its range, whose
    /// loop does not close, or whose corrected value exceeds 1e6. All numbers of a state are finite.
    #[inline]
    pub fn step(&self, readings: &[f64; JOINTS]) -> Result<State<JOINTS>, RuntimeError> {
        let (outputs, output_slopes) = self.transmissions.outputs(readings)?;
        let mut jacobian = [Twist::default(); JOINTS];
        let pose = self
            .chain
            .pose_and_jacobian_in_range(&outputs, &mut jacobian);
        Ok(State {
            outputs,
            output_slopes,
            pose,
            jacobian,
        })
    }
}
