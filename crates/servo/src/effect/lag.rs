//! A loop of finite gain: dx/dt = (u - x) / T, the answer of a proportional controller K against a damping D, T = D / K
//! (Franklin, Powell & Emami-Naeini, Feedback Control of Dynamic Systems, 4.2).

use std::ops::Range;

/// Low gain of the position loop.
pub(crate) const NAME: &str = "servo-stiffness";

/// Smooths a piece in place, from its first value on; exact for an input that goes from row to row along straight lines: over a step h
/// from u to v, x <- a x + (r - a) u + (1 - r) v, a = exp(-h/T), r = (1 - a) T / h. An input that holds is u till the next row.
pub(crate) fn lagged(
    time_s: &[f64],
    piece: Range<usize>,
    (lag_s, holds): (f64, bool),
    input: &mut [f64],
) {
    if lag_s <= 0.0 {
        return;
    }
    let (mut step, mut decay, mut ramp) = (f64::NAN, 0.0, 0.0);
    let mut before = input[piece.start];
    for row in piece.start + 1..piece.end {
        let own = time_s[row] - time_s[row - 1];
        // times of a log differ in their last digits
        if (own - step).abs() > 1e-7 || step.is_nan() {
            step = own;
            decay = (-own / lag_s).exp();
            ramp = match holds {
                true => 1.0,
                false => (1.0 - decay) * lag_s / own,
            };
        }
        let now = input[row];
        input[row] = decay * input[row - 1] + (ramp - decay) * before + (1.0 - ramp) * now;
        before = now;
    }
}
