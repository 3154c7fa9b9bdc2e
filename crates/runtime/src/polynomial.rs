//! An error as a Chebyshev series over a range of readings; beyond the range there is no answer.

use crate::error::{Refusal, SMALLEST_LENGTH, bounded};

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

/// A series as a step needs it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PreparedPolynomial {
    pub(crate) range: [f64; 2],
    /// d x / d reading, with x from -1 to 1 over the range.
    scale: f64,
    coefficients: [f64; POLYNOMIAL_TERMS],
}

impl PreparedPolynomial {
    pub(crate) const fn new(
        range: [f64; 2],
        coefficients: &[f64; POLYNOMIAL_TERMS],
    ) -> Result<Self, Refusal> {
        let [lower, upper] = range;
        if let Err(refusal) = bounded("range_rad", lower) {
            return Err(refusal);
        }
        if let Err(refusal) = bounded("range_rad", upper) {
            return Err(refusal);
        }
        if upper - lower < SMALLEST_LENGTH {
            return Err(Refusal {
                quantity: "range_rad",
                value: upper - lower,
                allowed: "two ascending ends at least 1e-9 apart (the value is their difference)",
            });
        }
        let mut index = 0;
        while index < POLYNOMIAL_TERMS {
            if let Err(refusal) = bounded("chebyshev", coefficients[index]) {
                return Err(refusal);
            }
            index += 1;
        }
        Ok(Self {
            range,
            scale: 2.0 / (upper - lower),
            coefficients: *coefficients,
        })
    }

    /// Error and slope at a reading within the range.
    ///
    /// Source: Clenshaw 1955; Press et al., Numerical Recipes, section 5.8.
    #[inline]
    pub(crate) fn error(&self, reading: f64) -> (f64, f64) {
        let [lower, upper] = self.range;
        let x = 0.5 * self.scale * ((reading - lower) - (upper - reading));
        let twice = 2.0 * x;
        let (mut b1, mut b2) = (0.0, 0.0);
        let (mut slope1, mut slope2) = (0.0, 0.0);
        let [constant, others @ ..] = &self.coefficients;
        for coefficient in others.iter().rev() {
            let slope0 = 2.0 * b1 + twice * slope1 - slope2;
            let b0 = coefficient + twice * b1 - b2;
            (slope1, slope2) = (slope0, slope1);
            (b1, b2) = (b0, b1);
        }
        (
            constant + x * b1 - b2,
            (b1 + x * slope1 - slope2) * self.scale,
        )
    }
}
