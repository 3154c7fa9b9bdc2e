//! A device with more moving rows than joints: rows that follow another row's joint.

use crate::error::{DeviceError, bounded, is_bounded};
use crate::transmission::PreparedTransmission;
use crate::{
    Convention, Frame, GeneralRow, Joint, Model, Motion, RuntimeError, State, Transmission, Twist,
};

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
/// The chain is a [`Model`] of the rows; a joint's column of the Jacobian is the sum of those of its rows,
/// each times its multiplier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoupledModel<const JOINTS: usize, const ROWS: usize> {
    chain: Model<ROWS>,
    drives: [RowDrive; ROWS],
    transmissions: [PreparedTransmission; JOINTS],
}

impl<const JOINTS: usize, const ROWS: usize> CoupledModel<JOINTS, ROWS> {
    /// Prepares a device; arguments as for [`Model::general`]. A joint's own motion is not looked at:
    /// each of its rows has one. Usable in a constant.
    ///
    /// # Errors
    /// [`DeviceError`] names the row or joint, the key and what is allowed.
    ///
    /// ```
    /// use haptical_runtime::*;
    /// // Two links of 0.1 m; the second turns back as far as the first turns.
    /// let arm = Row { a_m: 0.1, ..Row::default() };
    /// let rows = [GeneralRow { row: arm, ..GeneralRow::IDENTITY }; 2];
    /// let joint = Joint { motion: Motion::Revolute, home: 0.0, transmission: Transmission::Exact };
    /// let drives = [1.0, -1.0]
    ///     .map(|multiplier| RowDrive { motion: Motion::Revolute, joint: 0, multiplier, offset: 0.0 });
    /// let base = GeneralRow::IDENTITY;
    /// let model = CoupledModel::new(Convention::Standard, base, rows, None, [joint], drives)?;
    /// let state = model.step(&[core::f64::consts::FRAC_PI_2])?;
    /// assert!((state.position_m[0] - 0.1).abs() < 1e-15 && (state.position_m[1] - 0.1).abs() < 1e-15);
    /// assert!(state.jacobian[0].angular[2].abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub const fn new(
        convention: Convention,
        base: GeneralRow,
        rows: [GeneralRow; ROWS],
        handle: Option<Frame>,
        joints: [Joint; JOINTS],
        drives: [RowDrive; ROWS],
    ) -> Result<Self, DeviceError> {
        let mut transmissions = [PreparedTransmission::Exact; JOINTS];
        let mut index = 0;
        while index < JOINTS {
            if let Err(refusal) = bounded("home", joints[index].home) {
                return Err(refusal.at(index + 1));
            }
            transmissions[index] = match PreparedTransmission::new(&joints[index].transmission) {
                Ok(transmission) => transmission,
                Err(refusal) => return Err(refusal.at(index + 1)),
            };
            index += 1;
        }
        let mut axes = [Joint {
            motion: Motion::Revolute,
            home: 0.0,
            transmission: Transmission::Exact,
        }; ROWS];
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
                return Err(refusal.at(drive.joint + 1));
            }
            axes[row].motion = drive.motion;
            // its size is checked with the chain's other homes
            axes[row].home = drive.multiplier * joints[drive.joint].home + drive.offset;
            row += 1;
        }
        match Model::general(convention, base, rows, handle, axes) {
            Ok(chain) => Ok(Self {
                chain,
                drives,
                transmissions,
            }),
            Err(error) => Err(error),
        }
    }

    /// Readings within which the model holds, lowest and highest of each joint, \[rad\] or \[m\].
    #[must_use]
    pub fn ranges(&self) -> [[f64; 2]; JOINTS] {
        let mut ranges = [[0.0; 2]; JOINTS];
        for (range, transmission) in ranges.iter_mut().zip(&self.transmissions) {
            *range = transmission.range();
        }
        ranges
    }

    /// Where the device stands at `readings`: see [`Model::step`].
    ///
    /// # Errors
    /// [`RuntimeError`], as [`Model::step`]; [`RuntimeError::OutputOutOfRange`] also for a row's variable.
    #[inline]
    pub fn step(&self, readings: &[f64; JOINTS]) -> Result<State<JOINTS>, RuntimeError> {
        let mut outputs = [0.0; JOINTS];
        let mut output_slopes = [0.0; JOINTS];
        let mut variables = [0.0; ROWS];
        let results = outputs.iter_mut().zip(&mut output_slopes);
        for (joint, ((transmission, &reading), (output, slope))) in self
            .transmissions
            .iter()
            .zip(readings)
            .zip(results)
            .enumerate()
        {
            (*output, *slope) = transmission.output(joint + 1, transmission.range(), reading)?;
            for (variable, drive) in variables.iter_mut().zip(&self.drives) {
                if drive.joint == joint {
                    *variable = drive.multiplier * *output;
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
        let of_rows = self.chain.step(&variables)?;
        let mut jacobian = [Twist::default(); JOINTS];
        for (joint, column) in jacobian.iter_mut().enumerate() {
            for (drive, row) in self.drives.iter().zip(&of_rows.jacobian) {
                if drive.joint == joint {
                    add(&mut column.linear, row.linear, drive.multiplier);
                    add(&mut column.angular, row.angular, drive.multiplier);
                }
            }
        }
        Ok(State {
            outputs,
            output_slopes,
            position_m: of_rows.position_m,
            rotation: of_rows.rotation,
            jacobian,
        })
    }
}

/// Adds a multiple of a vector.
#[inline]
fn add(sum: &mut [f64; 3], vector: [f64; 3], factor: f64) {
    for (sum, component) in sum.iter_mut().zip(vector) {
        *sum += factor * component;
    }
}
