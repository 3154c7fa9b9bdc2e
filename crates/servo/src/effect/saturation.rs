//! A drive that turns no faster than its voltage and torque let it: |dx/dt| <= v.

use std::ops::Range;

/// Limit of the speed.
pub(crate) const NAME: &str = "speed-saturation";

/// Limits the speed of a piece in place; `slowness` is one over the limit, 0 for none.
pub(crate) fn limited(time_s: &[f64], piece: Range<usize>, slowness: f64, input: &mut [f64]) {
    if slowness <= 0.0 {
        return;
    }
    for row in piece.start + 1..piece.end {
        let most = (time_s[row] - time_s[row - 1]) / slowness;
        let step = input[row] - input[row - 1];
        input[row] = input[row - 1] + step.clamp(-most, most);
    }
}
