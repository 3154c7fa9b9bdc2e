//! The model itself: made once from a device, usable as a constant, then stepped in a loop.

use crate::error::{DeviceError, bounded};
use crate::state::cross;
use crate::transform::Transform;
use crate::transmission::PreparedTransmission;
use crate::{Convention, Frame, GeneralRow, Joint, Motion, Row, RuntimeError, State, Twist};

/// A calibrated device of `JOINTS` joints, ready for a control loop.
///
/// Whatever stands between two joint axes is one fixed rigid transform, whichever the convention:
/// home angles, offsets, twists and tilts cost nothing per step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Model<const JOINTS: usize> {
    /// From frame (-1) to the first joint's axis.
    base: Transform,
    axes: [Axis; JOINTS],
}

/// One joint and what follows it up to the next joint's axis, or to the handle.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Axis {
    motion: Motion,
    range: [f64; 2],
    transmission: PreparedTransmission,
    after: Transform,
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
    /// use haptical_runtime::{Convention, Joint, Model, Motion, Row, Transmission};
    /// let rows = [0.3, 0.2].map(|a_m| Row { a_m, ..Row::default() });
    /// let joint = Joint { motion: Motion::Revolute, home: 0.0, transmission: Transmission::Exact };
    /// let model = Model::new(Convention::Standard, Row::default(), rows, [joint; 2])?;
    /// let state = model.step(&[0.0, core::f64::consts::FRAC_PI_2])?;
    /// assert!((state.position_m[0] - 0.3).abs() < 1e-15);
    /// assert!((state.position_m[1] - 0.2).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub const fn new(
        convention: Convention,
        base: Row,
        rows: [Row; JOINTS],
        joints: [Joint; JOINTS],
    ) -> Result<Self, DeviceError> {
        let mut general = [GeneralRow::IDENTITY; JOINTS];
        let mut index = 0;
        while index < JOINTS {
            general[index].row = rows[index];
            index += 1;
        }
        let base = GeneralRow {
            row: base,
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
    /// use haptical_runtime::{Convention, Frame, GeneralRow, Joint, Model, Motion, Transmission};
    /// // A joint 0.4 m above the base, and a handle 0.1 m in front of it.
    /// let at = |x, z| Some(Frame { position_m: [x, 0.0, z], ..Frame::IDENTITY });
    /// let row = GeneralRow { origin: at(0.0, 0.4), ..GeneralRow::IDENTITY };
    /// let joint = Joint { motion: Motion::Revolute, home: 0.0, transmission: Transmission::Exact };
    /// let base = GeneralRow::IDENTITY;
    /// let model = Model::general(Convention::Standard, base, [row], at(0.1, 0.0), [joint])?;
    /// let position_m = model.step(&[core::f64::consts::FRAC_PI_2])?.position_m;
    /// assert!((position_m[1] - 0.1).abs() < 1e-15);
    /// assert_eq!(position_m[2], 0.4);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub const fn general(
        convention: Convention,
        base: GeneralRow,
        rows: [GeneralRow; JOINTS],
        handle: Option<Frame>,
        joints: [Joint; JOINTS],
    ) -> Result<Self, DeviceError> {
        if let Err(error) = base.check(0) {
            return Err(error);
        }
        let mut chain = Self {
            base: Transform::IDENTITY
                .placed(&base.origin)
                .before_joint(convention, &base)
                .after_joint(convention, &base),
            axes: [Axis {
                motion: Motion::Revolute,
                range: [0.0; 2],
                transmission: PreparedTransmission::Exact,
                after: Transform::IDENTITY,
            }; JOINTS],
        };
        let mut index = 0;
        while index < JOINTS {
            let joint = &joints[index];
            let row = match at_home(index, &rows[index], joint) {
                Ok(row) => row,
                Err(error) => return Err(error),
            };
            let transmission = match PreparedTransmission::new(&joint.transmission) {
                Ok(transmission) => transmission,
                Err(refusal) => return Err(refusal.at(index + 1)),
            };
            let before = match index {
                0 => &mut chain.base,
                _ => &mut chain.axes[index - 1].after,
            };
            *before = before.placed(&row.origin).before_joint(convention, &row);
            chain.axes[index] = Axis {
                motion: joint.motion,
                range: transmission.range(),
                transmission,
                after: Transform::IDENTITY.after_joint(convention, &row),
            };
            index += 1;
        }
        if let Some(frame) = &handle
            && !frame.is_rigid()
        {
            return Err(DeviceError::Origin { row: JOINTS + 1 });
        }
        let before = match JOINTS {
            0 => &mut chain.base,
            _ => &mut chain.axes[JOINTS - 1].after,
        };
        *before = before.placed(&handle);
        Ok(chain)
    }

    /// Readings within which the model holds, lowest and highest of each joint, \[rad\] or \[m\].
    ///
    /// For a polynomial this is the range it was fitted on; otherwise a size of 1e6 over the ratio. A
    /// parallelogram may refuse readings within: its loop must be closed.
    #[must_use]
    pub fn ranges(&self) -> [[f64; 2]; JOINTS] {
        let mut ranges = [[0.0; 2]; JOINTS];
        for (range, axis) in ranges.iter_mut().zip(&self.axes) {
            *range = axis.range;
        }
        ranges
    }

    /// Where the device stands at `readings`: motor-side encoder angles over the nominal ratios,
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
        let mut outputs = [0.0; JOINTS];
        let mut output_slopes = [0.0; JOINTS];
        let mut jacobian = [Twist {
            linear: [0.0; 3],
            angular: [0.0; 3],
        }; JOINTS];

        let mut frame = self.base;
        let results = outputs
            .iter_mut()
            .zip(&mut output_slopes)
            .zip(&mut jacobian);
        for (index, ((axis, reading), ((output, slope), column))) in
            self.axes.iter().zip(readings).zip(results).enumerate()
        {
            (*output, *slope) = axis.transmission.output(index + 1, axis.range, *reading)?;
            match axis.motion {
                Motion::Revolute => {
                    // the velocity replaces the point on the axis once the end is known
                    *column = Twist {
                        linear: frame.origin,
                        angular: frame.z,
                    };
                    frame = frame.turned_about_z(*output);
                }
                Motion::Prismatic => {
                    column.linear = frame.z;
                    frame = frame.slid_along_z(*output);
                }
            }
            frame = frame.then(&axis.after);
        }
        let [end0, end1, end2] = frame.origin;
        for (axis, column) in self.axes.iter().zip(&mut jacobian) {
            if axis.motion == Motion::Revolute {
                let [p0, p1, p2] = column.linear;
                column.linear = cross(column.angular, [end0 - p0, end1 - p1, end2 - p2]);
            }
        }
        let ([x0, x1, x2], [y0, y1, y2], [z0, z1, z2]) = (frame.x, frame.y, frame.z);
        Ok(State {
            outputs,
            output_slopes,
            position_m: frame.origin,
            rotation: [[x0, y0, z0], [x1, y1, z1], [x2, y2, z2]],
            jacobian,
        })
    }
}

/// The row with the joint's home added to what the joint moves.
const fn at_home(index: usize, row: &GeneralRow, joint: &Joint) -> Result<GeneralRow, DeviceError> {
    if let Err(error) = row.check(index + 1) {
        return Err(error);
    }
    if let Err(refusal) = bounded("home", joint.home) {
        return Err(refusal.at(index + 1));
    }
    let mut row = *row;
    match joint.motion {
        Motion::Revolute => row.row.theta_rad += joint.home,
        Motion::Prismatic => row.row.d_m += joint.home,
    }
    Ok(row)
}
