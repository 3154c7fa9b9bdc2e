//! Curves of uniform cubic B-splines (de Boor 1978): a curve of so many coefficients over a range that is cut into three
//! intervals less. Outside the range a curve keeps the value of its end.

/// Least number of coefficients: one interval.
pub const LEAST_COEFFICIENTS: usize = 4;

/// The four splines that are not zero at a place: the first one's number, their values, and their slopes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Splines {
    /// Number of the first of the four coefficients, from 0.
    pub first: usize,
    /// Values of the four splines.
    pub values: [f64; 4],
    /// Their derivatives by the place; 0 outside the range.
    pub slopes: [f64; 4],
}

impl Splines {
    /// The splines of a curve of `count` coefficients over `from` to `to` at a place, in any unit: at the part u of its interval
    /// (1 - u)^3 / 6, (3 u^3 - 6 u^2 + 4) / 6, (-3 u^3 + 3 u^2 + 3 u + 1) / 6, u^3 / 6. None for fewer than
    /// [`LEAST_COEFFICIENTS`], an empty range or a place that is no number.
    ///
    /// ```
    /// use haptical_transmission::spline::Splines;
    /// let splines = Splines::at(0.25, 0.0, 1.0, 5).ok_or("none")?;
    /// // in the middle of the first of two intervals
    /// assert_eq!(splines.first, 0);
    /// assert!((splines.values.iter().sum::<f64>() - 1.0).abs() < 1e-15);
    /// assert_eq!(splines.values[1], splines.values[2]);
    /// assert!(Splines::at(0.25, 0.0, 1.0, 3).is_none());
    /// # Ok::<(), &str>(())
    /// ```
    #[must_use]
    pub fn at(place: f64, from: f64, to: f64, count: usize) -> Option<Self> {
        let is_sound = count >= LEAST_COEFFICIENTS && to > from && (to - from) < f64::MAX;
        if !is_sound || place.is_nan() {
            return None;
        }
        let intervals = count + 1 - LEAST_COEFFICIENTS;
        let width = (to - from) / intervals as f64;
        let along = (place.clamp(from, to) - from) / width;
        // the upper end belongs to the last interval; `as` goes down
        let first = (along as usize).min(intervals - 1);
        let u = along - first as f64;
        let v = 1.0 - u;
        let is_inside = from <= place && place <= to;
        let slope = if is_inside { 0.5 / width } else { 0.0 };
        Some(Self {
            first,
            values: [
                v * v * v / 6.0,
                ((3.0 * u - 6.0) * u * u + 4.0) / 6.0,
                (((3.0 - 3.0 * u) * u + 3.0) * u + 1.0) / 6.0,
                u * u * u / 6.0,
            ],
            slopes: [
                -slope * v * v,
                slope * (3.0 * u - 4.0) * u,
                slope * ((2.0 - 3.0 * u) * u + 1.0),
                slope * u * u,
            ],
        })
    }
}

/// Value of a curve at a place, and its slope; none where [`Splines::at`] is none.
///
/// ```
/// use haptical_transmission::spline::curve;
/// // coefficients on a line are that line: the knots of five over 0 to 2 lie at -1, 0, 1, 2, 3
/// let (value, slope) = curve(0.3, 0.0, 2.0, &[-1.0, 0.0, 1.0, 2.0, 3.0]).ok_or("none")?;
/// assert!((value - 0.3).abs() < 1e-15 && (slope - 1.0).abs() < 1e-15);
/// let (end, slope) = curve(9.0, 0.0, 2.0, &[-1.0, 0.0, 1.0, 2.0, 3.0]).ok_or("none")?;
/// assert!((end - 2.0).abs() < 1e-15 && slope == 0.0);
/// # Ok::<(), &str>(())
/// ```
#[must_use]
pub fn curve(place: f64, from: f64, to: f64, coefficients: &[f64]) -> Option<(f64, f64)> {
    let splines = Splines::at(place, from, to, coefficients.len())?;
    let own = coefficients.get(splines.first..splines.first + 4)?;
    let (mut value, mut slope) = (0.0, 0.0);
    for (coefficient, (spline, derivative)) in
        own.iter().zip(splines.values.iter().zip(&splines.slopes))
    {
        value += coefficient * spline;
        slope += coefficient * derivative;
    }
    Some((value, slope))
}
