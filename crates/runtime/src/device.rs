//! A device as plain numbers: its rows and joints, as a device file holds them.

use haptical_kinematics::{
    Convention, Link, Motion as RowMotion, Parameter, Pose, Preparation, PreparedChain,
};

use crate::Transmission;
use crate::error::{DeviceError, LARGEST_NUMBER, attempt, bounded, is_bounded};
use crate::transmission::PreparedTransmission;

/// What a joint does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// Turns about z; its values are in rad.
    Revolute,
    /// Slides along z; its values are in m.
    Prismatic,
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
        Ok(attempt!(self.prepared(joint)).range())
    }

    /// The transmission as a step needs it.
    pub(crate) const fn prepared(&self, joint: usize) -> Result<PreparedTransmission, DeviceError> {
        if let Err(refusal) = bounded("home", self.home) {
            return Err(refusal.for_joint(joint));
        }
        match PreparedTransmission::new(&self.transmission) {
            Ok(transmission) => Ok(transmission),
            Err(refusal) => Err(refusal.for_joint(joint)),
        }
    }
}

/// A row with a constant transform before it, as devices from a URDF have them:
/// [`Model::general`](crate::Model::general).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GeneralRow {
    /// Constant transform before the row.
    pub origin: Option<Pose>,
    /// The row's numbers.
    pub link: Link,
}

impl GeneralRow {
    /// A row that does nothing but move with its joint.
    pub const IDENTITY: Self = Self {
        origin: None,
        link: Link::IDENTITY,
    };

    /// Whether the runtime can hold the row's numbers; `row` is its number, from 0, for the error.
    ///
    /// # Errors
    /// [`DeviceError::Row`], [`DeviceError::Origin`].
    ///
    /// ```
    /// use haptical_runtime::{DeviceError, GeneralRow, Pose};
    /// let mirror = Pose::from_rows([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]);
    /// let row = GeneralRow { origin: Some(mirror), ..GeneralRow::IDENTITY };
    /// assert_eq!(row.check(3), Err(DeviceError::Origin { row: 3 }));
    /// ```
    pub const fn check(&self, row: usize) -> Result<(), DeviceError> {
        /// Keys of the device file, in the order of [`Parameter::ALL`].
        const KEYS: [&str; 6] = [
            "a_m",
            "alpha_rad",
            "d_m",
            "theta_offset_rad",
            "beta_rad",
            "b_m",
        ];
        attempt!(check_origin(&self.origin, row));
        let mut index = 0;
        while index < KEYS.len() {
            let value = self.link.get(Parameter::ALL[index]);
            if !is_bounded(value) {
                return Err(DeviceError::Row {
                    row,
                    quantity: KEYS[index],
                    value,
                });
            }
            index += 1;
        }
        Ok(())
    }
}

const fn check_origin(origin: &Option<Pose>, row: usize) -> Result<(), DeviceError> {
    match origin {
        Some(pose) if !pose.is_rigid(LARGEST_NUMBER) => Err(DeviceError::Origin { row }),
        _ => Ok(()),
    }
}

/// Prepares the chain of a device whose rows behind row 0 move, each from its home.
pub(crate) const fn prepared_chain<const ROWS: usize>(
    convention: Convention,
    base: &GeneralRow,
    rows: &[GeneralRow; ROWS],
    handle: &Option<Pose>,
    moves: &[(Motion, f64); ROWS],
) -> Result<PreparedChain<ROWS>, DeviceError> {
    attempt!(base.check(0));
    let mut chain = placed(Preparation::EMPTY, &base.origin);
    chain = chain.row(convention, &base.link, RowMotion::Fixed);
    let mut index = 0;
    while index < ROWS {
        let (row, (motion, home)) = (&rows[index], moves[index]);
        attempt!(row.check(index + 1));
        if let Err(refusal) = bounded("home", home) {
            return Err(refusal.for_joint(index + 1));
        }
        let mut link = row.link;
        let motion = match motion {
            Motion::Revolute => {
                link.theta_rad += home;
                RowMotion::Revolute
            }
            Motion::Prismatic => {
                link.d_m += home;
                RowMotion::Prismatic
            }
        };
        chain = placed(chain, &row.origin).row(convention, &link, motion);
        index += 1;
    }
    attempt!(check_origin(handle, ROWS + 1));
    Ok(PreparedChain::from_constants(
        placed(chain, handle).finish(),
    ))
}

const fn placed<const ROWS: usize>(
    chain: Preparation<ROWS>,
    origin: &Option<Pose>,
) -> Preparation<ROWS> {
    match origin {
        Some(pose) => chain.origin(pose),
        None => chain,
    }
}
