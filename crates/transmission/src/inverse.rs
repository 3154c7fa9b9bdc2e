//! The encoder angle that brings the output to a wanted angle: safeguarded Newton on a bracket.

use crate::error::{LawError, ascending, finite};

/// Points inside the bracket at which growth is checked before the search, and by which it is narrowed.
const MONOTONICITY_CHECKS: usize = 8;

/// A Newton step below this ends the search, rad. The next step would be of the order of its square,
/// so the promised 1e-12 rad is met with a digit to spare.
const LAST_STEP_RAD: f64 = 1e-13;

/// Steps after which the search gives up; bisection alone needs 54 from 1000 rad to the last step.
const MAX_ITERATIONS: usize = 200;

/// Rounding of a residual over the sizes of its three terms, with room for that of `error` itself.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A point of the search: encoder angle, output angle less the wanted one and its rounding, slope of
/// the output angle.
#[derive(Clone, Copy)]
struct Point {
    theta_rad: f64,
    residual_rad: f64,
    rounding_rad: f64,
    slope: f64,
}

/// Solves `theta + error(theta) = output_rad` for `theta` within `bracket_rad`, all in rad, to 1e-12
/// rad (or the spacing of the numbers, if that is wider).
///
/// `error` returns the error in rad and its slope in rad/rad. Newton's step
/// `theta - (theta + error - output) / (1 + slope)` is taken while it stays inside the bracket and
/// shrinks it at least as bisection would; otherwise the bracket is halved.
///
/// The inverse is unique only if the output angle grows throughout. That is checked at both ends, at
/// eight points spread evenly between them and at each step; a fold that lies between all of these is
/// not seen.
///
/// Source: Press et al., Numerical Recipes, section 9.4 (Newton's method with bisection).
///
/// # Errors
/// What `error` returns; [`LawError::NonFinite`] and [`LawError::InvalidRange`] for
/// bad arguments; [`LawError::NotMonotone`] where the output angle was seen not to grow;
/// [`LawError::NotBracketed`] if the wanted angle is not reached between the ends;
/// [`LawError::NoConvergence`] for a bracket too wide to be searched.
///
/// ```
/// use haptical_transmission::invert;
/// let ripple = |theta: f64| Ok((0.01 * (8.0 * theta).sin(), 0.08 * (8.0 * theta).cos()));
/// let theta_rad = invert(ripple, 0.3, [-1.0, 1.0])?;
/// assert!((theta_rad + 0.01 * (8.0 * theta_rad).sin() - 0.3).abs() < 1e-12);
/// # Ok::<(), haptical_transmission::LawError>(())
/// ```
pub fn invert(
    mut error: impl FnMut(f64) -> Result<(f64, f64), LawError>,
    output_rad: f64,
    bracket_rad: [f64; 2],
) -> Result<f64, LawError> {
    finite("output angle, rad", output_rad)?;
    let [lower_rad, upper_rad] = ascending("bracket", bracket_rad)?;
    let mut point = |theta_rad| growing_point(&mut error, output_rad, theta_rad);

    let (mut low, mut high) = narrowed(&mut point, output_rad, [lower_rad, upper_rad])?;
    let mut here = if -low.residual_rad < high.residual_rad {
        low
    } else {
        high
    };
    let mut step_before_rad = high.theta_rad - low.theta_rad;
    for _ in 0..MAX_ITERATIONS {
        let newton_step_rad = -here.residual_rad / here.slope;
        let newton_rad = here.theta_rad + newton_step_rad;
        let inside = low.theta_rad <= newton_rad && newton_rad <= high.theta_rad;
        let next_rad = if inside && 2.0 * newton_step_rad.abs() <= step_before_rad.abs() {
            newton_rad
        } else {
            low.theta_rad + 0.5 * (high.theta_rad - low.theta_rad)
        };
        let step_rad = next_rad - here.theta_rad;
        let width_rad = high.theta_rad - low.theta_rad;
        // Ends that are neighbouring numbers have a midpoint that rounds to one and the same of them,
        // so far from zero, where no step is as small as the last one allowed, the search ends here.
        if here.residual_rad == 0.0 || step_rad == 0.0 {
            return Ok(here.theta_rad);
        }
        if step_rad.abs().min(width_rad) <= LAST_STEP_RAD {
            return Ok(next_rad);
        }
        step_before_rad = step_rad;
        here = point(next_rad)?;
        in_order(low, here)?;
        in_order(here, high)?;
        if here.residual_rad < 0.0 {
            low = here;
        } else {
            high = here;
        }
    }
    Err(LawError::NoConvergence {
        output_rad,
        theta_rad: here.theta_rad,
        iterations: MAX_ITERATIONS,
    })
}

/// Checks growth over the bracket and returns the pair of neighbouring check points between which the
/// residual changes its sign.
fn narrowed(
    mut point: impl FnMut(f64) -> Result<Point, LawError>,
    output_rad: f64,
    [lower_rad, upper_rad]: [f64; 2],
) -> Result<(Point, Point), LawError> {
    let first = point(lower_rad)?;
    let last = point(upper_rad)?;
    let (mut low, mut high) = (first, last);
    let mut before = first;
    for check in 1..=MONOTONICITY_CHECKS {
        let fraction = check as f64 / (MONOTONICITY_CHECKS + 1) as f64;
        let next = point(lower_rad + fraction * (upper_rad - lower_rad))?;
        in_order(before, next)?;
        before = next;
        if next.residual_rad <= 0.0 {
            low = next;
        } else if high.residual_rad > next.residual_rad {
            high = next;
        }
    }
    in_order(before, last)?;
    if first.residual_rad > 0.0 || last.residual_rad < 0.0 {
        return Err(LawError::NotBracketed {
            output_rad,
            bracket_rad: [lower_rad, upper_rad],
            reached_rad: [
                output_rad + first.residual_rad,
                output_rad + last.residual_rad,
            ],
        });
    }
    Ok((low, high))
}

/// Evaluates the output angle and refuses a point at which it does not grow.
fn growing_point(
    mut error: impl FnMut(f64) -> Result<(f64, f64), LawError>,
    output_rad: f64,
    theta_rad: f64,
) -> Result<Point, LawError> {
    let (error_rad, error_slope) = error(theta_rad)?;
    let residual_rad = finite("error, rad", (theta_rad - output_rad) + error_rad)?;
    let slope = finite("slope of the error, rad/rad", 1.0 + error_slope)?;
    if slope > 0.0 {
        let rounding_rad = ROUNDING * (theta_rad.abs() + output_rad.abs() + error_rad.abs());
        Ok(Point {
            theta_rad,
            residual_rad,
            rounding_rad,
            slope,
        })
    } else {
        Err(LawError::NotMonotone { theta_rad, slope })
    }
}

/// Refuses two points of which the later has the smaller output angle, beyond rounding: slopes alone
/// do not show a jump or a fold between two points.
fn in_order(earlier: Point, later: Point) -> Result<(), LawError> {
    let rise_rad = later.residual_rad - earlier.residual_rad;
    if rise_rad >= -(earlier.rounding_rad + later.rounding_rad) {
        return Ok(());
    }
    let run_rad = later.theta_rad - earlier.theta_rad;
    Err(LawError::NotMonotone {
        theta_rad: later.theta_rad,
        slope: rise_rad / run_rad,
    })
}
