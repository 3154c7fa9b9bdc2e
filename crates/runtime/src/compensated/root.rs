//! A reading at which a continuous function of it is zero.

use crate::RuntimeError;

/// First distance of the ends from the start.
const FIRST_STEP: f64 = 1e-3;
/// Each step outwards is so many times the one before.
const GROWTH: f64 = 4.0;
/// Steps outwards: 1e-3 times 4^8 is 65.
const STEPS: usize = 9;
/// Halvings at most: each step of the search at least halves every third time.
const HALVINGS: usize = 120;
/// Width of a bracket that is not worth another step.
const NARROW: f64 = 1e-15;

/// The zero near a start, within the ends; none where the function does not change its sign there.
///
/// Steps outwards until the sign changes, then false position with halved weights (Illinois; Dowell & Jarratt 1971), and
/// bisection where that is slow: a play and a loop have corners.
pub(super) fn zero_near(
    start: f64,
    [lower, upper]: [f64; 2],
    function: impl Fn(f64) -> Result<f64, RuntimeError>,
) -> Result<Option<f64>, RuntimeError> {
    let start = start.max(lower).min(upper);
    let at_start = function(start)?;
    if at_start == 0.0 {
        return Ok(Some(start));
    }
    // a rising function is below zero before its zero
    let direction = if at_start < 0.0 { 1.0 } else { -1.0 };
    let (mut near, mut at_near, mut step) = (start, at_start, FIRST_STEP);
    for _ in 0..STEPS {
        let far = (near + direction * step).max(lower).min(upper);
        let at_far = function(far)?;
        if at_far == 0.0 {
            return Ok(Some(far));
        }
        if (at_far < 0.0) != (at_near < 0.0) {
            return bracketed([near, far], [at_near, at_far], function).map(Some);
        }
        if far == near {
            return Ok(None);
        }
        (near, at_near) = (far, at_far);
        step *= GROWTH;
    }
    Ok(None)
}

/// The zero between two ends of different signs.
fn bracketed(
    [mut a, mut b]: [f64; 2],
    [mut at_a, mut at_b]: [f64; 2],
    function: impl Fn(f64) -> Result<f64, RuntimeError>,
) -> Result<f64, RuntimeError> {
    let mut last_side = 0;
    for round in 0..HALVINGS {
        let width = (b - a).abs();
        if width <= NARROW * a.abs().max(b.abs()).max(1.0) {
            break;
        }
        let middle = 0.5 * (a + b);
        let secant = b - at_b * (b - a) / (at_b - at_a);
        let is_inside = (secant - a) * (secant - b) < 0.0;
        let next = if round % 3 == 2 || !is_inside {
            middle
        } else {
            secant
        };
        let at_next = function(next)?;
        if at_next == 0.0 {
            return Ok(next);
        }
        if (at_next < 0.0) == (at_a < 0.0) {
            (a, at_a) = (next, at_next);
            if last_side == 1 {
                at_b *= 0.5;
            }
            last_side = 1;
        } else {
            (b, at_b) = (next, at_next);
            if last_side == 2 {
                at_a *= 0.5;
            }
            last_side = 2;
        }
    }
    // the end that was worked out is as good as the other one
    Ok(if last_side == 1 { a } else { b })
}
