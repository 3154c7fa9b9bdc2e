//! A command that takes effect late: u(t) = c(t - d).

use std::ops::Range;

/// Bus, controller and driver.
pub(crate) const NAME: &str = "command-latency";

/// The readings, of which their velocities know nothing.
pub(crate) const OF_READINGS: &str = "encoder-latency";

/// The command `delay_s` before each row of a piece, between rows along a straight line; before the first row the first one.
pub(crate) fn delayed(
    command: &[f64],
    time_s: &[f64],
    piece: Range<usize>,
    delay_s: f64,
    out: &mut [f64],
) {
    let mut at = piece.start;
    for row in piece.clone() {
        let wanted = time_s[row] - delay_s;
        while at + 1 < piece.end && time_s[at + 1] <= wanted {
            at += 1;
        }
        out[row] = if wanted <= time_s[piece.start] {
            command[piece.start]
        } else if at + 1 < piece.end {
            let share = (wanted - time_s[at]) / (time_s[at + 1] - time_s[at]);
            command[at] + share * (command[at + 1] - command[at])
        } else {
            command[piece.end - 1]
        };
    }
}
