//! Transmissions between encoders and joints, and the corrected joint values at readings.

use haptical_kinematics::trigonometry::LARGEST_RAD;
use haptical_transmission::chebyshev;

use crate::capstan::PreparedCapstan;
use crate::error::{DeviceError, Refusal, SMALLEST_LENGTH, attempt, bounded, is_bounded};
use crate::parallelogram::PreparedParallelogram;
use crate::{Capstan, Joint, Parallelogram, RuntimeError};

/// Terms of a polynomial: degree 24, the highest that the command fits. All are evaluated, so that
/// the work does not depend on the device.
pub const POLYNOMIAL_TERMS: usize = 25;

/// Coefficients filled up with zeros; more than [`POLYNOMIAL_TERMS`] do not compile.
///
/// ```
/// assert_eq!(haptical_runtime::padded([1e-3, 2e-3])[..3], [1e-3, 2e-3, 0.0]);
/// ```
#[must_use]
pub const fn padded<const TERMS: usize>(coefficients: [f64; TERMS]) -> [f64; POLYNOMIAL_TERMS] {
    const {
        assert!(
            TERMS <= POLYNOMIAL_TERMS,
            "a polynomial of degree 24 at most"
        );
    };
    let mut all = [0.0; POLYNOMIAL_TERMS];
    let mut index = 0;
    while index < TERMS {
        all[index] = coefficients[index];
        index += 1;
    }
    all
}

/// Error of a transmission: the joint's value is reading + error(reading).
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(
    clippy::large_enum_variant,
    reason = "without an allocator the largest variant has nowhere else to be"
)]
pub enum Transmission {
    /// None.
    Exact,
    /// Baser & Konukseven eq. (1).
    Capstan(Capstan),
    /// Baser & Konukseven eqs. (1) and (2).
    Parallelogram(Parallelogram),
    /// A Chebyshev series.
    Polynomial {
        /// Range of readings on which it holds, \[rad\] or \[m\].
        range: [f64; 2],
        /// Coefficients of T_0, T_1, ..., \[rad\] or \[m\]; see [`padded`](crate::padded).
        coefficients: [f64; POLYNOMIAL_TERMS],
    },
}

/// A transmission as a step needs it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(
    clippy::large_enum_variant,
    reason = "without an allocator the largest variant has nowhere else to be"
)]
pub(crate) enum PreparedTransmission {
    Exact,
    Capstan(PreparedCapstan),
    Parallelogram(PreparedParallelogram),
    Polynomial {
        range: [f64; 2],
        coefficients: [f64; POLYNOMIAL_TERMS],
    },
}

impl PreparedTransmission {
    pub(crate) const fn new(transmission: &Transmission) -> Result<Self, Refusal> {
        Ok(match transmission {
            Transmission::Exact => Self::Exact,
            Transmission::Capstan(capstan) => {
                Self::Capstan(attempt!(PreparedCapstan::new(capstan)))
            }
            Transmission::Parallelogram(parallelogram) => {
                Self::Parallelogram(attempt!(PreparedParallelogram::new(parallelogram)))
            }
            Transmission::Polynomial {
                range,
                coefficients,
            } => {
                attempt!(check_polynomial(*range, coefficients));
                Self::Polynomial {
                    range: *range,
                    coefficients: *coefficients,
                }
            }
        })
    }

    /// Readings that a step takes.
    pub(crate) const fn range(&self) -> [f64; 2] {
        let largest = match self {
            Self::Exact => LARGEST_RAD,
            Self::Capstan(capstan) => capstan.largest_reading(),
            Self::Parallelogram(parallelogram) => parallelogram.largest_reading(),
            Self::Polynomial { range, .. } => return *range,
        };
        [-largest, largest]
    }

    /// Joint value and d(joint value)/d(reading).
    // as `outputs`
    #[inline(always)]
    pub(crate) fn output(
        &self,
        joint: usize,
        [lower, upper]: [f64; 2],
        reading: f64,
    ) -> Result<(f64, f64), RuntimeError> {
        // NaN is not inside either.
        if !(lower <= reading && reading <= upper) {
            return Err(refuse(joint, lower, upper, reading));
        }
        let (error, slope) = match self {
            Self::Exact => (0.0, 0.0),
            Self::Capstan(capstan) => capstan.error(reading),
            Self::Parallelogram(parallelogram) => match parallelogram.error(reading) {
                Some(error) => error,
                None => return Err(RuntimeError::OpenLoop { joint, reading }),
            },
            Self::Polynomial {
                range,
                coefficients,
            } => chebyshev::evaluate(*range, coefficients, reading),
        };
        let output = reading + error;
        if !is_bounded(output) {
            return Err(RuntimeError::OutputOutOfRange {
                joint,
                reading,
                output,
            });
        }
        Ok((output, 1.0 + slope))
    }
}

/// Refuses a series that has no answer, or whose sum may leave the range of numbers.
const fn check_polynomial(
    [lower, upper]: [f64; 2],
    coefficients: &[f64; POLYNOMIAL_TERMS],
) -> Result<(), Refusal> {
    attempt!(bounded("range_rad", lower));
    attempt!(bounded("range_rad", upper));
    if upper - lower < SMALLEST_LENGTH {
        return Err(Refusal {
            quantity: "range_rad",
            value: upper - lower,
            allowed: "two ascending ends at least 1e-9 apart (the value is their difference)",
        });
    }
    let mut index = 0;
    while index < POLYNOMIAL_TERMS {
        attempt!(bounded("chebyshev", coefficients[index]));
        index += 1;
    }
    Ok(())
}

#[cold]
fn refuse(joint: usize, lower: f64, upper: f64, reading: f64) -> RuntimeError {
    if reading.is_finite() {
        RuntimeError::ReadingOutOfRange {
            joint,
            reading,
            lower,
            upper,
        }
    } else {
        RuntimeError::NonFiniteReading { joint, reading }
    }
}

/// The transmissions of a device, and the readings that each takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Transmissions<const JOINTS: usize> {
    transmissions: [PreparedTransmission; JOINTS],
    pub(crate) ranges: [[f64; 2]; JOINTS],
}

impl<const JOINTS: usize> Transmissions<JOINTS> {
    pub(crate) const fn new(joints: &[Joint; JOINTS]) -> Result<Self, DeviceError> {
        let mut prepared = Self {
            transmissions: [PreparedTransmission::Exact; JOINTS],
            ranges: [[0.0; 2]; JOINTS],
        };
        let mut index = 0;
        while index < JOINTS {
            let transmission = attempt!(joints[index].prepared(index + 1));
            prepared.ranges[index] = transmission.range();
            prepared.transmissions[index] = transmission;
            index += 1;
        }
        Ok(prepared)
    }

    /// The value of one joint and its slope; none for a joint that is not there.
    pub(crate) fn output(
        &self,
        joint: usize,
        reading: f64,
    ) -> Option<Result<(f64, f64), RuntimeError>> {
        let (transmission, range) = self.transmissions.get(joint).zip(self.ranges.get(joint))?;
        Some(transmission.output(joint + 1, *range, reading))
    }

    /// Joint values and d(joint value)/d(reading).
    // in a program with several callers it is called rather than inlined, with its arrays through memory
    #[inline(always)]
    pub(crate) fn outputs(
        &self,
        readings: &[f64; JOINTS],
    ) -> Result<([f64; JOINTS], [f64; JOINTS]), RuntimeError> {
        let (mut outputs, mut slopes) = ([0.0; JOINTS], [0.0; JOINTS]);
        let joints = self.transmissions.iter().zip(&self.ranges).zip(readings);
        let into = outputs.iter_mut().zip(&mut slopes);
        for (index, (((transmission, range), reading), (output, slope))) in
            joints.zip(into).enumerate()
        {
            (*output, *slope) = transmission.output(index + 1, *range, *reading)?;
        }
        Ok((outputs, slopes))
    }
}
