//! Value, slope and parameter derivatives of an error function at one angle.

use crate::error::{LawError, finite};

/// A transmission error at one encoder angle together with its first derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evaluation<const N: usize> {
    /// Error, added to the encoder angle.
    pub value_rad: f64,
    /// Derivative of the error with respect to the encoder angle, rad/rad.
    pub slope: f64,
    /// Derivative of the error with respect to each parameter, rad per unit of the parameter.
    pub derivatives: [f64; N],
}

impl<const N: usize> Evaluation<N> {
    /// Passes the evaluation on if all its numbers are finite: extreme finite arguments can overflow.
    pub(crate) fn checked(self) -> Result<Self, LawError> {
        finite("error, rad", self.value_rad)?;
        finite("slope of the error, rad/rad", self.slope)?;
        for derivative in self.derivatives {
            finite(
                "derivative of the error with respect to a parameter",
                derivative,
            )?;
        }
        Ok(self)
    }
}
