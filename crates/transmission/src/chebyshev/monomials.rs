//! Conversion between a Chebyshev series over a range and powers of the angle.
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
    let (centre_rad, half_width_rad) = prepare(range_rad, coefficients, out)?;
    // T_k = 2 x T_{k-1} - T_{k-2} takes one factor x out of all terms but the constant; what remains
    // is a series of one degree less.
    for start in 0..out.len() {
        let series = out.get_mut(start..).unwrap_or_default();
        for k in (2..series.len()).rev() {
            series[k - 2] -= series[k];
            series[k] *= 2.0;
        }
    }
    scale_argument(out, 1.0 / half_width_rad);
    shift_argument(out, -centre_rad);
    all_finite(out)
}

/// Writes the Chebyshev coefficients `c_0 .. c_n` (rad) over the range that equal the polynomial
/// `sum_i k_i theta^i` with the powers `monomials` `k_0 .. k_n` (rad per rad^i). `out` has the length
/// of `monomials`, any degree. Inverse of [`to_monomials`].
///
/// Source: Mason & Handscomb, section 2.3, read backwards.
///
/// # Errors
/// As [`to_monomials`].
///
/// ```
/// use haptical_transmission::chebyshev::from_monomials;
/// let mut coefficients = [0.0; 3];
/// from_monomials([-1.0, 1.0], &[0.0, 0.0, 1.0], &mut coefficients)?; // x^2 = (T_0 + T_2) / 2
/// assert_eq!(coefficients, [0.5, 0.0, 0.5]);
/// # Ok::<(), haptical_transmission::LawError>(())
/// ```
pub fn from_monomials(
    range_rad: [f64; 2],
    monomials: &[f64],
    out: &mut [f64],
) -> Result<(), LawError> {
    let (centre_rad, half_width_rad) = prepare(range_rad, monomials, out)?;
    shift_argument(out, centre_rad);
    scale_argument(out, half_width_rad);
    for start in (0..out.len()).rev() {
        let series = out.get_mut(start..).unwrap_or_default();
        for k in 2..series.len() {
            series[k] *= 0.5;
            series[k - 2] += series[k];
        }
    }
    all_finite(out)
}

/// Copies the checked input to `out` and returns centre and half width of the checked range.
fn prepare(range_rad: [f64; 2], input: &[f64], out: &mut [f64]) -> Result<(f64, f64), LawError> {
    let [lower_rad, upper_rad] = ascending("range", range_rad)?;
    if out.len() != input.len() {
        return Err(LawError::LengthMismatch {
            quantity: "output slice",
            got: out.len(),
            expected: input.len(),
        });
    }
    all_finite(input)?;
    out.copy_from_slice(input);
    let half_width_rad = 0.5 * (upper_rad - lower_rad);
    Ok((lower_rad + half_width_rad, half_width_rad))
}

/// Powers of `y` become powers of `theta` for `y = factor * theta`.
fn scale_argument(powers: &mut [f64], factor: f64) {
    let mut scale = 1.0;
    for power in powers {
        *power *= scale;
        scale *= factor;
    }
}

/// Powers of `y` become powers of `theta` for `y = theta + shift`, by repeated synthetic division.
fn shift_argument(powers: &mut [f64], shift: f64) {
    for start in 0..powers.len() {
        for k in (start + 1..powers.len()).rev() {
            powers[k - 1] += shift * powers[k];
        }
    }
}

fn all_finite(numbers: &[f64]) -> Result<(), LawError> {
    for number in numbers {
        finite("polynomial coefficient", *number)?;
    }
    Ok(())
}
