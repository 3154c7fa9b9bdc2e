//! The digits that a number earns by how well it is known.

/// Digits after the point of a value whose interval has this half width: as many as show two significant ones of the half
/// width (JCGM 100:2008, 7.2.6); none where there is no width.
///
/// ```
/// use haptical_report::earned_decimals;
/// assert_eq!(earned_decimals(0.0123), Some(3)); // 2.134 with 0.012
/// assert_eq!(earned_decimals(15.0), Some(0)); // 258 with 15
/// assert_eq!(earned_decimals(0.0), None);
/// ```
pub fn earned_decimals(half_width: f64) -> Option<usize> {
    // A hair more, so that a half of 0.1 that rounding makes 0.09999 has no digit more.
    let half = half_width * (1.0 + 1e-9);
    let is_known = half > 0.0 && half.is_finite();
    is_known.then(|| (1.0 - half.log10().floor()).clamp(0.0, MOST) as usize)
}

/// Most digits after the point.
const MOST: f64 = 9.0;
