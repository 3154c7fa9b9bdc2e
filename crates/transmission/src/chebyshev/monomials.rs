//! Conversion of a Chebyshev series over a range to powers of the angle.
//!
//! The conversion is exact in exact arithmetic. In floating point it loses digits with the degree `n`
//! and with the range: a Chebyshev coefficient of 1 becomes powers whose sizes add up to
//! `(1 + sqrt 2)^n / 2` on `[-1, 1]` (3363 for n = 10) and to `(3 + sqrt 8)^n / 2` on `[0, 1]`
//! (2.3e7 for n = 10), so a range that does not contain 0 well inside should stay a Chebyshev series.

use crate::error::{LawError, ascending, finite};

/// Writes the powers `k_0 .. k_n` of `sum_i k_i theta^i` (rad per rad^i) that equal the Chebyshev
/// series with `coefficients` `c_0 .. c_n` (rad) over the range; this is how the paper prints its
/// polynomial. `out` has the length of `coefficients`, any degree.
///
/// Source: Baser & Konukseven, Tables 2 and 4 (the form of the result); Mason & Handscomb, section
/// 2.3 (the recurrence).
///
/// # Errors
/// [`LawError::LengthMismatch`], [`LawError::InvalidRange`],
/// [`LawError::NonFinite`] for a coefficient or a power that is not finite.
///
/// ```
/// use haptical_transmission::chebyshev::to_monomials;
/// let mut powers = [0.0; 3];
/// to_monomials([-2.0, 2.0], &[0.0, 0.0, 1.0], &mut powers)?; // 2 (theta / 2)^2 - 1
/// assert_eq!(powers, [-1.0, 0.0, 0.5]);
/// # Ok::<(), haptical_transmission::LawError>(())
/// ```
pub fn to_monomials(
    range_rad: [f64; 2],
    coefficients: &[f64],
    out: &mut [f64],
) -> Result<(), LawError> {
    let [lower_rad, upper_rad] = ascending("range", range_rad)?;
    if out.len() != coefficients.len() {
        return Err(LawError::LengthMismatch {
            quantity: "output slice",
            got: out.len(),
            expected: coefficients.len(),
        });
    }
    all_finite(coefficients)?;
    out.copy_from_slice(coefficients);
    // T_k = 2 x T_{k-1} - T_{k-2} takes one factor x out of all terms but the constant; what remains
    // is a series of one degree less.
    for start in 0..out.len() {
        let series = out.get_mut(start..).unwrap_or_default();
        for k in (2..series.len()).rev() {
            series[k - 2] -= series[k];
            series[k] *= 2.0;
        }
    }
    // x is the distance from the centre over the half width: first powers of that distance ...
    let half_width_rad = 0.5 * (upper_rad - lower_rad);
    let factor = 1.0 / half_width_rad;
    let mut scale = 1.0;
    for power in out.iter_mut() {
        *power *= scale;
        scale *= factor;
    }
    // ... then, by repeated synthetic division, of the angle
    let centre_rad = lower_rad + half_width_rad;
    for start in 0..out.len() {
        for k in (start + 1..out.len()).rev() {
            out[k - 1] -= centre_rad * out[k];
        }
    }
    all_finite(out)
}

fn all_finite(numbers: &[f64]) -> Result<(), LawError> {
    for number in numbers {
        finite("polynomial coefficient", *number)?;
    }
    Ok(())
}
