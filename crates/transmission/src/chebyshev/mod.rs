//! An error as a Chebyshev series over a stated range of angles, continued on its tangents.
//!
//! A series `sum_k c_k T_k(x)`, `x = (2 theta - lower - upper) / (upper - lower)`, is the same
//! polynomials as powers of `theta`, but a degree-10 fit to it is well conditioned and its coefficients
//! are sizes of error in rad. [`to_monomials`] converts it to powers.
//!
//! Outside the range each `T_k` goes on along its tangent at the end, so value and slope are
//! continuous and grow linearly: a fitted polynomial says nothing outside the data, and a joint that
//! overruns its range by a degree must not meet the tenth power of that.
//!
//! [`basis`], [`evaluate`] and [`contains`] do not return errors, so that they cost nothing in a
//! control loop; whoever brings a range or coefficients from outside calls [`check`] once. For a range
//! that is not ascending, or an argument that is not finite, the first two give NaN.

mod monomials;

pub use monomials::to_monomials;

use crate::error::{LawError, ascending, finite};

/// Whether the range is ascending and finite, and all coefficients (rad) are finite.
///
/// # Errors
/// [`LawError::InvalidRange`], [`LawError::NonFinite`].
pub fn check(range_rad: [f64; 2], coefficients: &[f64]) -> Result<(), LawError> {
    ascending("range", range_rad)?;
    for coefficient in coefficients {
        finite("Chebyshev coefficient, rad", *coefficient)?;
    }
    Ok(())
}

/// Whether `theta_rad` lies within the range, ends included.
///
/// ```
/// use haptical_transmission::chebyshev::contains;
/// assert!(contains([-0.5, 0.7], 0.7) && !contains([-0.5, 0.7], 0.71));
/// ```
#[must_use]
pub fn contains(range_rad: [f64; 2], theta_rad: f64) -> bool {
    range_rad[0] <= theta_rad && theta_rad <= range_rad[1]
}

/// Writes `T_0 .. T_{n-1}` at `theta_rad` to the `n` entries of `out` (no unit).
///
/// Inside the range `T_0 = 1`, `T_1 = x`, `T_k = 2 x T_{k-1} - T_{k-2}`. Outside,
/// `T_k(x) = e^k + k^2 e^{k+1} (x - e)` with the end `e = 1` or `-1`.
///
/// Source: Mason & Handscomb, Chebyshev Polynomials, eq. (1.3); the tangents are this crate's.
/// Limits: see the module on arguments that are not finite.
///
/// ```
/// use haptical_transmission::chebyshev::basis;
/// let mut t = [0.0; 4];
/// basis([-2.0, 2.0], 1.0, &mut t); // x = 1/2
/// assert_eq!(t, [1.0, 0.5, -0.5, -1.0]);
/// basis([-2.0, 2.0], 4.0, &mut t); // x = 2: tangents at 1, of slopes k^2
/// assert_eq!(t, [1.0, 2.0, 5.0, 10.0]);
/// ```
pub fn basis(range_rad: [f64; 2], theta_rad: f64, out: &mut [f64]) {
    let (end, beyond) = split(unit_coordinate(range_rad, theta_rad));
    let (mut before, mut here) = (end, 1.0);
    for (k, t) in out.iter_mut().enumerate() {
        *t = here;
        if beyond != 0.0 {
            // At an end T_k = e^k, which the recurrence yields without rounding, and
            // T_k' = k^2 e^{k+1} = k^2 e T_k.
            *t += (k * k) as f64 * end * here * beyond;
        }
        (before, here) = (here, 2.0 * end * here - before);
    }
}

/// Value in rad and slope in rad/rad of `sum_k c_k T_k` at `theta_rad`, with `coefficients` `c_k` in
/// rad; an empty slice is zero.
///
/// Clenshaw's recurrence for the value and, differentiated, for the slope; outside the range the
/// tangent at the end.
///
/// Source: Clenshaw 1955; Press et al., Numerical Recipes, section 5.8.
/// Limits: see the module on arguments that are not finite.
///
/// ```
/// use haptical_transmission::chebyshev::evaluate;
/// // T_2(x) = 2 x^2 - 1 with x = theta / 2
/// let (value_rad, slope) = evaluate([-2.0, 2.0], &[0.0, 0.0, 1.0], 1.0);
/// assert_eq!((value_rad, slope), (-0.5, 1.0));
/// ```
#[inline]
#[must_use]
pub fn evaluate(range_rad: [f64; 2], coefficients: &[f64], theta_rad: f64) -> (f64, f64) {
    let (x, beyond) = split(unit_coordinate(range_rad, theta_rad));
    let (mut b1, mut b2) = (0.0, 0.0);
    let (mut slope1, mut slope2) = (0.0, 0.0);
    let (constant, others) = match coefficients.split_first() {
        Some((constant, others)) => (*constant, others),
        None => (0.0, coefficients),
    };
    for &coefficient in others.iter().rev() {
        let slope0 = 2.0 * (b1 + x * slope1) - slope2;
        let b0 = coefficient + 2.0 * x * b1 - b2;
        (slope1, slope2) = (slope0, slope1);
        (b1, b2) = (b0, b1);
    }
    let value_rad = constant + x * b1 - b2;
    let slope_per_x = b1 + x * slope1 - slope2;
    let x_per_rad = 2.0 / (range_rad[1] - range_rad[0]);
    (value_rad + slope_per_x * beyond, slope_per_x * x_per_rad)
}

/// `x` in `[-1, 1]` over the range. The distances to both ends are used so that each end is met
/// without rounding; a range that is not ascending gives NaN.
#[inline]
fn unit_coordinate([lower_rad, upper_rad]: [f64; 2], theta_rad: f64) -> f64 {
    let width_rad = upper_rad - lower_rad;
    if width_rad > 0.0 {
        (theta_rad - lower_rad) / width_rad - (upper_rad - theta_rad) / width_rad
    } else {
        f64::NAN
    }
}

/// The nearest `x` within `[-1, 1]` and how far beyond it the argument lies.
#[inline]
fn split(x: f64) -> (f64, f64) {
    let inside = x.clamp(-1.0, 1.0);
    (inside, x - inside)
}
