//! What stands between an encoder and its joint, and the corrected joint value at a reading.

use crate::capstan::PreparedCapstan;
use crate::error::{Refusal, is_bounded};
use crate::parallelogram::PreparedParallelogram;
use crate::polynomial::PreparedPolynomial;
use crate::{Capstan, POLYNOMIAL_TERMS, Parallelogram, RuntimeError};

/// Error of a transmission: the joint stands at reading + error(reading).
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
    Polynomial(PreparedPolynomial),
}

impl PreparedTransmission {
    pub(crate) const fn new(transmission: &Transmission) -> Result<Self, Refusal> {
        match transmission {
            Transmission::Exact => Ok(Self::Exact),
            Transmission::Capstan(capstan) => match PreparedCapstan::new(capstan) {
                Ok(prepared) => Ok(Self::Capstan(prepared)),
                Err(refusal) => Err(refusal),
            },
            Transmission::Parallelogram(parallelogram) => {
                match PreparedParallelogram::new(parallelogram) {
                    Ok(prepared) => Ok(Self::Parallelogram(prepared)),
                    Err(refusal) => Err(refusal),
                }
            }
            Transmission::Polynomial {
                range,
                coefficients,
            } => match PreparedPolynomial::new(*range, coefficients) {
                Ok(prepared) => Ok(Self::Polynomial(prepared)),
                Err(refusal) => Err(refusal),
            },
        }
    }

    /// Readings that a step takes.
    pub(crate) const fn range(&self) -> [f64; 2] {
        let largest = match self {
            Self::Exact => crate::LARGEST_ANGLE_RAD,
            Self::Capstan(capstan) => capstan.largest_reading(),
            Self::Parallelogram(parallelogram) => parallelogram.largest_reading(),
            Self::Polynomial(polynomial) => return polynomial.range,
        };
        [-largest, largest]
    }

    /// Joint value and d(joint value)/d(reading).
    #[inline]
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
            Self::Polynomial(polynomial) => polynomial.error(reading),
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
