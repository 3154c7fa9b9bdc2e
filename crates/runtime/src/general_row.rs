//! A row with a slide along y and a constant transform before it, as devices from a URDF have them.

use crate::Row;
use crate::error::{DeviceError, is_bounded};
use crate::state::dot;

/// A constant rigid transform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Position \[m\].
    pub position_m: [f64; 3],
    /// Rotation, `rotation[row][column]`: its axes are the columns.
    pub rotation: [[f64; 3]; 3],
}

impl Frame {
    /// No displacement and no turn.
    pub const IDENTITY: Self = Self {
        position_m: [0.0; 3],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };

    /// Whether all numbers are of bounded size and the rotation neither stretches nor mirrors.
    pub(crate) const fn is_rigid(&self) -> bool {
        /// What six digits in a file leave of a rotation.
        const TOLERANCE: f64 = 1e-6;
        let [first, second, third] = self.rotation;
        let products = [
            dot(first, first) - 1.0,
            dot(second, second) - 1.0,
            dot(third, third) - 1.0,
            dot(first, second),
            dot(second, third),
            dot(third, first),
        ];
        let mut index = 0;
        while index < products.len() {
            if products[index].is_nan() || products[index].abs() > TOLERANCE {
                return false;
            }
            index += 1;
        }
        let [x, y, z] = self.position_m;
        is_bounded(x)
            && is_bounded(y)
            && is_bounded(z)
            && dot(crate::state::cross(first, second), third) > 0.0
    }
}

/// A row as [`Model::general`](crate::Model::general) takes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GeneralRow {
    /// Constant transform before the row.
    pub origin: Option<Frame>,
    /// The row's five Denavit-Hartenberg and Hayati numbers.
    pub row: Row,
    /// Length along y, which acts with the length along x \[m\].
    pub b_m: f64,
}

impl GeneralRow {
    /// A row that does nothing but move with its joint.
    pub const IDENTITY: Self = Self {
        origin: None,
        row: Row {
            a_m: 0.0,
            alpha_rad: 0.0,
            d_m: 0.0,
            theta_rad: 0.0,
            beta_rad: 0.0,
        },
        b_m: 0.0,
    };

    /// Whether the runtime can hold the row's numbers; `row` is its number, from 0, for the error.
    ///
    /// # Errors
    /// [`DeviceError::Row`], [`DeviceError::Origin`].
    ///
    /// ```
    /// use haptical_runtime::{DeviceError, Frame, GeneralRow};
    /// let mirror = Frame { rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]], ..Frame::IDENTITY };
    /// let row = GeneralRow { origin: Some(mirror), ..GeneralRow::IDENTITY };
    /// assert_eq!(row.check(3), Err(DeviceError::Origin { row: 3 }));
    /// ```
    pub const fn check(&self, row: usize) -> Result<(), DeviceError> {
        if let Some(origin) = &self.origin
            && !origin.is_rigid()
        {
            return Err(DeviceError::Origin { row });
        }
        if !is_bounded(self.b_m) {
            return Err(DeviceError::Row {
                row,
                quantity: "b_m",
                value: self.b_m,
            });
        }
        self.row.check(row)
    }
}
