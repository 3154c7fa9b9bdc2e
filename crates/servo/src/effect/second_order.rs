//! A joint with a mass on the spring of its loop: T2^2 x'' + T1 x' + x = u, with the natural frequency 1 / T2 and the damping ratio
//! T1 / (2 T2) (Franklin, Powell & Emami-Naeini, Feedback Control of Dynamic Systems, 3.3).
//!
//! A command that is slow next to it comes T1 later, and with a damping ratio of 0.7 nothing but late: x = u - T1 u' + (T1^2 - T2^2) u'',
//! where a delay d has d^2 / 2 in the place of T1^2 - T2^2.

use std::ops::Range;

/// How a joint of some mass answers: its two times, and whether its commands hold from row to row.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Answer {
    /// T1 \[s\].
    pub(crate) lag_s: f64,
    /// T2 \[s\]; 0 without a mass.
    pub(crate) inertia_s: f64,
    /// Commands hold till the next row; else they go there along a straight line.
    pub(crate) holds: bool,
}

impl Answer {
    /// Lets a piece be followed in place from a joint that rests at its first value; exact between rows.
    ///
    /// Over a step h from u to v the joint is at v - T1 s + e, of the speed s + de/dt, where s = (v - u) / h and e is the free motion
    /// from x - u + T1 s and dx/dt - s. A command that holds has s = 0 and ends at u.
    pub(crate) fn followed(&self, time_s: &[f64], piece: Range<usize>, input: &mut [f64]) {
        let (mut step, mut free) = (f64::NAN, [[0.0; 2]; 2]);
        let mut before = input[piece.start];
        let (mut at, mut speed) = (before, 0.0);
        for row in piece.start + 1..piece.end {
            let own = time_s[row] - time_s[row - 1];
            // times of a log differ in their last digits
            if (own - step).abs() > 1e-7 || step.is_nan() {
                step = own;
                free = self.free(own);
            }
            let now = input[row];
            let (slope, end) = match self.holds {
                true => (0.0, before),
                false => ((now - before) / own, now),
            };
            let from = [at - before + self.lag_s * slope, speed - slope];
            let [off, rate] = free.map(|row| row[0] * from[0] + row[1] * from[1]);
            (at, speed) = (end - self.lag_s * slope + off, slope + rate);
            input[row] = at;
            before = now;
        }
    }

    /// What position and speed of a free motion are after a time, of what they are before.
    fn free(&self, after_s: f64) -> [[f64; 2]; 2] {
        let squared = self.inertia_s.powi(-2);
        let decay = 0.5 * self.lag_s * squared;
        let inside = decay * decay - squared;
        let root = inside.abs().sqrt();
        // exp(-decay t) times cos and sin / root, or cosh and sinh / root
        let (cosine, sine) = if root * after_s < 1e-6 {
            let falls = (-decay * after_s).exp();
            (falls, falls * after_s)
        } else if inside < 0.0 {
            let falls = (-decay * after_s).exp();
            let (sine, cosine) = (root * after_s).sin_cos();
            (falls * cosine, falls * sine / root)
        } else {
            // the slow pole without the difference of two large numbers
            let slow = (-squared / (decay + root) * after_s).exp();
            let fast = (-(decay + root) * after_s).exp();
            (0.5 * (slow + fast), 0.5 * (slow - fast) / root)
        };
        [
            [cosine + decay * sine, sine],
            [-squared * sine, cosine - decay * sine],
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::Answer;
    use crate::effect::lag;

    fn times() -> Vec<f64> {
        (0..200).map(|row| 0.01 * f64::from(row)).collect()
    }

    /// Steps of a ten-thousandth of a row.
    fn integrated(answer: Answer, time_s: &[f64], command: &[f64]) -> Vec<f64> {
        let (mut at, mut speed) = (command[0], 0.0);
        let mut course = vec![at];
        for row in 1..time_s.len() {
            let step = (time_s[row] - time_s[row - 1]) / 1e4;
            for part in 0..10_000 {
                let share = (f64::from(part) + 0.5) / 1e4;
                let share = if answer.holds { 0.0 } else { share };
                let wanted = command[row - 1] + share * (command[row] - command[row - 1]);
                let pull = wanted - at - answer.lag_s * speed;
                speed += step * pull / answer.inertia_s.powi(2);
                at += step * speed;
            }
            course.push(at);
        }
        course
    }

    #[test]
    fn a_mass_on_a_spring_follows_as_its_equation_says() {
        let time_s = times();
        let command: Vec<f64> = (time_s.iter())
            .map(|t| 0.4 * (7.0 * t).sin() + if *t > 0.8 { 0.5 } else { 0.0 })
            .collect();
        // weakly damped, just so that it does not swing, strongly damped
        for (lag_s, inertia_s) in [(0.01, 0.02), (0.04, 0.02), (0.1, 0.02)] {
            for holds in [false, true] {
                let answer = Answer {
                    lag_s,
                    inertia_s,
                    holds,
                };
                let mut course = command.clone();
                answer.followed(&time_s, 0..command.len(), &mut course);
                let wanted = integrated(answer, &time_s, &command);
                for (own, wanted) in course.iter().zip(&wanted) {
                    assert!((own - wanted).abs() < 1e-4, "{answer:?}: {own} {wanted}");
                }
            }
        }
    }

    #[test]
    fn without_a_mass_it_is_a_lag() {
        let time_s = times();
        let command: Vec<f64> = time_s.iter().map(|t| (5.0 * t).sin()).collect();
        let (mut heavy, mut light) = (command.clone(), command.clone());
        let answer = Answer {
            lag_s: 0.05,
            inertia_s: 1e-4,
            holds: false,
        };
        answer.followed(&time_s, 0..200, &mut heavy);
        lag::lagged(&time_s, 0..200, (0.05, false), &mut light);
        for (own, wanted) in heavy.iter().zip(&light) {
            assert!((own - wanted).abs() < 1e-3, "{own} {wanted}");
        }
    }
}
