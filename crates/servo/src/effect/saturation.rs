//! A drive that turns no faster than its voltage and torque let it: dx/dt is (u - x) / T within the limits -v and v (the saturated
//! actuator of a proportional loop: Franklin, Powell & Emami-Naeini, Feedback Control of Dynamic Systems, 9.3).

use std::ops::Range;

use crate::thresholds::SWITCHES;

/// Limit of the speed.
pub(crate) const NAME: &str = "speed-saturation";

/// Lets a piece be followed in place by a joint of a lag and a limit, one over which is `slowness`; exact for an input that goes from row to
/// row along straight lines, or that holds.
pub(crate) fn limited(
    time_s: &[f64],
    piece: Range<usize>,
    (lag_s, slowness, holds): (f64, f64, bool),
    input: &mut [f64],
) {
    if slowness <= 0.0 {
        return;
    }
    let most = 1.0 / slowness;
    let (mut step, mut decay) = (f64::NAN, 0.0);
    let mut before = input[piece.start];
    for row in piece.start + 1..piece.end {
        let step_s = time_s[row] - time_s[row - 1];
        // times of a log differ in their last digits
        if (step_s - step).abs() > 1e-7 || step.is_nan() {
            step = step_s;
            decay = (-step_s / lag_s).exp();
        }
        let now = input[row];
        let (slope, end) = match holds {
            true => (0.0, before),
            false => ((now - before) / step_s, now),
        };
        let behind = match lag_s > 0.0 {
            true => {
                let at = before - input[row - 1];
                behind(at, slope, (lag_s, most), (step_s, decay))
            }
            // without a lag the joint is at its limit or at its input
            false => {
                let wanted = end - input[row - 1];
                wanted - wanted.clamp(-most * step_s, most * step_s)
            }
        };
        input[row] = end - behind;
        before = now;
    }
}

/// How far a joint is behind its input after a time, of how far it is before and the input's speed. `decay`: what a lag leaves of it then.
fn behind(before: f64, slope: f64, (lag_s, most): (f64, f64), (step_s, decay): (f64, f64)) -> f64 {
    let edge = lag_s * most;
    let (mut at, mut left) = (before, step_s);
    for _ in 0..SWITCHES {
        // the side on which the joint is at its limit; at an edge the one to which the input goes
        let side = at.signum();
        let rate = slope - side * most;
        let is_limited = at.abs() > edge || (at.abs() >= edge && rate * side >= 0.0);
        if is_limited {
            let until = match rate * side < 0.0 {
                true => (edge - at.abs()) / (rate * side),
                false => f64::INFINITY,
            };
            if until >= left {
                return at + rate * left;
            }
            (at, left) = (side * edge, left - until);
        } else {
            // towards T times the input's speed
            let rests = lag_s * slope;
            let decay = match left < step_s {
                true => (-left / lag_s).exp(),
                false => decay,
            };
            let end = rests + (at - rests) * decay;
            if end.abs() <= edge {
                return end;
            }
            let edge = edge.copysign(end);
            let until = lag_s * ((at - rests) / (edge - rests)).ln();
            (at, left) = (edge, left - until.clamp(0.0, left));
        }
    }
    at
}

#[cfg(test)]
mod tests {
    use super::limited;
    use crate::effect::lag;

    #[test]
    fn a_drive_is_no_faster_up_than_down() {
        let time_s: Vec<f64> = (0..8).map(|row| 0.1 * f64::from(row)).collect();
        let mut course = [0.0, 0.5, 0.5, 0.5, 0.0, 0.0, 0.0, 0.1];
        // 2 rad/s: a fifth in a tenth of a second
        limited(&time_s, 0..8, (0.0, 0.5, false), &mut course);
        let wanted = [0.0, 0.2, 0.4, 0.5, 0.3, 0.1, 0.0, 0.1];
        for (own, wanted) in course.iter().zip(wanted) {
            assert!((own - wanted).abs() < 1e-12, "{course:?}");
        }
    }

    #[test]
    fn a_lag_within_a_limit_follows_as_its_equation_says() {
        let time_s: Vec<f64> = (0..300).map(|row| 0.02 * f64::from(row)).collect();
        let command: Vec<f64> = (time_s.iter())
            .map(|t| (2.0 * t).sin() + if (1.0..2.0).contains(t) { 0.4 } else { 0.0 })
            .collect();
        for (lag_s, most) in [(0.05, 1.5), (0.01, 0.8), (0.2, 4.0), (0.05, 100.0)] {
            let mut course = command.clone();
            limited(&time_s, 0..300, (lag_s, 1.0 / most, false), &mut course);
            let mut at = command[0];
            for row in 1..300 {
                for part in 0..4000 {
                    let share = (f64::from(part) + 0.5) / 4000.0;
                    let wanted = command[row - 1] + share * (command[row] - command[row - 1]);
                    at += 0.02 / 4000.0 * ((wanted - at) / lag_s).clamp(-most, most);
                }
                assert!((course[row] - at).abs() < 1e-4, "{lag_s} {most} {row}");
            }
            if most > 10.0 {
                let mut alone = command.clone();
                lag::lagged(&time_s, 0..300, (lag_s, false), &mut alone);
                assert!(course.iter().zip(&alone).all(|(a, b)| (a - b).abs() < 1e-9));
            }
        }
    }
}
