//! What describes a device: its rows and joints as plain numbers, as a device file holds them.

use crate::Transmission;
use crate::error::{DeviceError, bounded, is_bounded};
use crate::transmission::PreparedTransmission;

/// The order in which the motions of a row act.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Convention {
    /// Distal: `Rz(theta) T(a, 0, d) Rx(alpha) Ry(beta)`, Baser & Konukseven eq. (3).
    Standard,
    /// Proximal (Craig): `Tx(a) Rx(alpha) Ry(beta) Rz(theta) Tz(d)`.
    Modified,
}

/// What a joint does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// Turns about z; its values are in rad.
    Revolute,
    /// Slides along z; its values are in m.
    Prismatic,
}

/// One Denavit-Hartenberg row with Hayati's `beta`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Row {
    /// Length along x \[m\].
    pub a_m: f64,
    /// Twist about x \[rad\].
    pub alpha_rad: f64,
    /// Offset along z \[m\].
    pub d_m: f64,
    /// Angle about z at home 0 and joint value 0 \[rad\].
    pub theta_rad: f64,
    /// Tilt about y \[rad\].
    pub beta_rad: f64,
}

/// One joint: what it does, where its home is, and what is between encoder and axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// What it does.
    pub motion: Motion,
    /// Joint variable at home, \[rad\] or \[m\].
    pub home: f64,
    /// Error of the transmission.
    pub transmission: Transmission,
}

impl Joint {
    /// Readings within which the joint's transmission is known, lowest and highest, \[rad\] or \[m\].
    /// `joint` is the joint's number, from 1, for the error.
    ///
    /// # Errors
    /// [`DeviceError::Joint`] if the runtime cannot hold a number of this joint.
    ///
    /// ```
    /// use haptical_runtime::{Joint, Motion, Transmission};
    /// let joint = Joint { motion: Motion::Revolute, home: 0.5, transmission: Transmission::Exact };
    /// assert_eq!(joint.range(1)?, [-1e6, 1e6]);
    /// # Ok::<(), haptical_runtime::DeviceError>(())
    /// ```
    pub const fn range(&self, joint: usize) -> Result<[f64; 2], DeviceError> {
        if let Err(refusal) = bounded("home", self.home) {
            return Err(refusal.at(joint));
        }
        match PreparedTransmission::new(&self.transmission) {
            Ok(transmission) => Ok(transmission.range()),
            Err(refusal) => Err(refusal.at(joint)),
        }
    }
}

impl Row {
    /// Whether the runtime can hold the row's numbers; `row` is its number, from 0, for the error.
    ///
    /// # Errors
    /// [`DeviceError::Row`].
    pub const fn check(&self, row: usize) -> Result<(), DeviceError> {
        let numbers = [
            ("a_m", self.a_m),
            ("alpha_rad", self.alpha_rad),
            ("d_m", self.d_m),
            ("theta_offset_rad", self.theta_rad),
            ("beta_rad", self.beta_rad),
        ];
        let mut index = 0;
        while index < numbers.len() {
            let (quantity, value) = numbers[index];
            if !is_bounded(value) {
                return Err(DeviceError::Row {
                    row,
                    quantity,
                    value,
                });
            }
            index += 1;
        }
        Ok(())
    }
}
