//! A device with more moving rows than joints: rows that follow another row's joint.

use haptical_kinematics::{Convention, Pose, PreparedChain, Twist};

use crate::device::prepared_chain;
use crate::error::{DeviceError, attempt, bounded, is_bounded};
use crate::limits::Limits;
use crate::transmission::Transmissions;
use crate::{GeneralRow, Joint, Motion, RuntimeError, State};

/// What drives a row: its variable is `multiplier (home + output) + offset` of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RowDrive {
    /// Whether the row turns or slides.
    pub motion: Motion,
    /// Joint that drives it, from 0.
    pub joint: usize,
    /// Row variable per joint variable.
    pub multiplier: f64,
    /// Row variable where the joint variable is 0, \[rad\] or \[m\].
    pub offset: f64,
}

/// A calibrated device of `JOINTS` joints that move `ROWS` rows, ready for a control loop.
///
/// The chain is that of the rows; a joint's column of the Jacobian is the sum of those of its rows,
/// each times its multiplier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoupledModel<const JOINTS: usize, const ROWS: usize> {
    pub(crate) transmissions: Transmissions<JOINTS>,
    pub(crate) chain: PreparedChain<ROWS>,
    pub(crate) drives: [RowDrive; ROWS],
    pub(crate) limits: Limits<JOINTS>,
}

impl<const JOINTS: usize, const ROWS: usize> CoupledModel<JOINTS, ROWS> {
    /// Prepares a device; arguments as for [`Model::general`](crate::Model::general). A joint's own motion is not looked at:
    /// each of its rows has one. Usable in a constant.
    ///
    /// # Errors
    /// [`DeviceError`] names the row or joint, the key and what is allowed.
    ///
    /// ```
    /// use haptical_runtime::*;
    /// // Two links of 0.1 m; the second turns back as far as the first turns.
    /// let link = Link { a_m: 0.1, ..Link::IDENTITY };
    /// let rows = [GeneralRow { link, ..GeneralRow::IDENTITY }; 2];
    /// let joint = Joint { motion: Motion::Revolute, home: 0.0, transmission: Transmission::Exact };
    /// let drives = [1.0, -1.0]
    ///     .map(|multiplier| RowDrive { motion: Motion::Revolute, joint: 0, multiplier, offset: 0.0 });
    /// let base = GeneralRow::IDENTITY;
    /// let model = CoupledModel::new(Convention::Standard, base, rows, None, [joint], drives)?;
    /// let state = model.step(&[core::f64::consts::FRAC_PI_2])?;
    /// let position_m = state.pose.position_m;
    /// assert!((position_m.x - 0.1).abs() < 1e-15 && (position_m.y - 0.1).abs() < 1e-15);
    /// assert!(state.jacobian[0].angular[2].abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub const fn new(
        convention: Convention,
        base: GeneralRow,
        rows: [GeneralRow; ROWS],
        handle: Option<Pose>,
        joints: [Joint; JOINTS],
        drives: [RowDrive; ROWS],
    ) -> Result<Self, DeviceError> {
        let transmissions = attempt!(Transmissions::new(&joints));
        let mut moves = [(Motion::Revolute, 0.0); ROWS];
        let mut row = 0;
        while row < ROWS {
            let drive = &drives[row];
            if drive.joint >= JOINTS {
                return Err(DeviceError::Drive {
                    row: row + 1,
                    joint: drive.joint + 1,
                    joints: JOINTS,
                });
            }
            if let Err(refusal) = bounded("driven_multiplier", drive.multiplier) {
                return Err(refusal.for_joint(drive.joint + 1));
            }
            // its size is checked with the chain's other homes
            let home = drive.multiplier * joints[drive.joint].home + drive.offset;
            moves[row] = (drive.motion, home);
            row += 1;
        }
        Ok(Self {
            transmissions,
            chain: attempt!(prepared_chain(convention, &base, &rows, &handle, &moves)),
            drives,
            limits: Limits::NONE,
        })
    }

    /// Readings within which the model holds, lowest and highest of each joint, \[rad\] or \[m\].
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
    #[inline]
    pub fn check_limits(&self, readings: &[f64; JOINTS]) -> Result<(), RuntimeError> {
        self.limits.check(readings)
    }

    /// The device's state at `readings`: see [`Model::step`](crate::Model::step).
    ///
    /// # Errors
    /// [`RuntimeError`], as [`Model::step`](crate::Model::step); [`RuntimeError::OutputOutOfRange`] also for a row's variable.
    #[inline]
    pub fn step(&self, readings: &[f64; JOINTS]) -> Result<State<JOINTS>, RuntimeError> {
        let (outputs, output_slopes) = self.transmissions.outputs(readings)?;
        let variables = self.variables(&outputs, readings)?;
        let mut of_rows = [Twist::default(); ROWS];
        let pose = self
            .chain
            .pose_and_jacobian_in_range(&variables, &mut of_rows);
        let jacobian = self.of_joints(&of_rows);
        Ok(State {
            outputs,
            output_slopes,
            pose,
            jacobian,
        })
    }
    /// The rows' variables at joint values; readings are for the error.
    #[inline]
    pub(crate) fn variables(
        &self,
        outputs: &[f64; JOINTS],
        readings: &[f64; JOINTS],
    ) -> Result<[f64; ROWS], RuntimeError> {
        let mut variables = [0.0; ROWS];
        for (joint, (&output, &reading)) in outputs.iter().zip(readings).enumerate() {
            for (variable, drive) in variables.iter_mut().zip(&self.drives) {
                if drive.joint == joint {
                    *variable = drive.multiplier * output;
                    if !is_bounded(*variable) {
                        return Err(RuntimeError::OutputOutOfRange {
                            joint: joint + 1,
                            reading,
                            output: *variable,
                        });
                    }
                }
            }
        }
        Ok(variables)
    }

    /// The joints' columns of a Jacobian from those of the rows.
    #[inline]
    pub(crate) fn of_joints(&self, of_rows: &[Twist; ROWS]) -> [Twist; JOINTS] {
        let mut jacobian = [Twist::default(); JOINTS];
        for (joint, column) in jacobian.iter_mut().enumerate() {
            for (drive, row) in self.drives.iter().zip(of_rows) {
                if drive.joint == joint {
                    column.linear += row.linear * drive.multiplier;
                    column.angular += row.angular * drive.multiplier;
                }
            }
        }
        jacobian
    }
}

impl<const JOINTS: usize> CoupledModel<JOINTS, JOINTS> {
    /// A device whose every joint moves a row of its own, as one of rows and drives. Usable in a constant.
    ///
    /// ```
    /// use haptical_runtime::*;
    /// let arm = Link { a_m: 0.3, ..Link::IDENTITY };
    /// let joint = Joint { motion: Motion::Revolute, home: 0.0, transmission: Transmission::Exact };
    /// let model = Model::new(Convention::Standard, Link::IDENTITY, [arm], [joint])?;
    /// let coupled = CoupledModel::of_rows(model);
    /// assert_eq!(coupled.step(&[0.4])?, model.step(&[0.4])?);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub const fn of_rows(model: crate::Model<JOINTS>) -> Self {
        let mut drives = [RowDrive {
            motion: Motion::Revolute,
            joint: 0,
            multiplier: 1.0,
            offset: 0.0,
        }; JOINTS];
        let mut row = 0;
        while row < JOINTS {
            drives[row].joint = row;
            if model.chain.constants().joints[row].is_prismatic {
                drives[row].motion = Motion::Prismatic;
            }
            row += 1;
        }
        Self {
            transmissions: model.transmissions,
            chain: model.chain,
            drives,
            limits: model.limits,
        }
    }
}
