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

#[cfg(test)]
mod tests {
    use super::limited;

    #[test]
    fn a_drive_is_no_faster_up_than_down() {
        let time_s: Vec<f64> = (0..8).map(|row| 0.1 * f64::from(row)).collect();
        let mut course = [0.0, 0.5, 0.5, 0.5, 0.0, 0.0, 0.0, 0.1];
        // 2 rad/s: a fifth in a tenth of a second
        limited(&time_s, 0..8, 0.5, &mut course);
        let wanted = [0.0, 0.2, 0.4, 0.5, 0.3, 0.1, 0.0, 0.1];
        for (own, wanted) in course.iter().zip(wanted) {
            assert!((own - wanted).abs() < 1e-12, "{course:?}");
        }
    }
}
