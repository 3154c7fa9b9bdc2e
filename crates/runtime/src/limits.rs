//! The joint limits of a device, and whether readings lie within them.

use crate::RuntimeError;
use crate::error::{DeviceError, Refusal};

/// Lowest and highest reading of each joint, \[rad\] or \[m\]; infinite where there is no limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Limits<const JOINTS: usize>(pub(crate) [[f64; 2]; JOINTS]);

impl<const JOINTS: usize> Limits<JOINTS> {
    /// A device without limits.
    pub(crate) const NONE: Self = Self([[f64::NEG_INFINITY, f64::INFINITY]; JOINTS]);

    pub(crate) const fn new(limits: [[f64; 2]; JOINTS]) -> Result<Self, DeviceError> {
        let mut index = 0;
        while index < JOINTS {
            let [lower, upper] = limits[index];
            // NaN is below nothing
            let is_below = lower < upper;
            if !is_below {
                let refusal = Refusal {
                    quantity: "lower limit",
                    value: lower,
                    allowed: "below the upper limit",
                };
                return Err(refusal.for_joint(index + 1));
            }
            index += 1;
        }
        Ok(Self(limits))
    }

    /// The first reading that is not finite or beyond its limits.
    #[inline]
    pub(crate) fn check(&self, readings: &[f64; JOINTS]) -> Result<(), RuntimeError> {
        for (index, (&[lower, upper], &reading)) in self.0.iter().zip(readings).enumerate() {
            let joint = index + 1;
            if !reading.is_finite() {
                return Err(RuntimeError::NonFiniteReading { joint, reading });
            }
            if reading < lower || reading > upper {
                return Err(RuntimeError::BeyondLimit {
                    joint,
                    reading,
                    lower,
                    upper,
                });
            }
        }
        Ok(())
    }
}
