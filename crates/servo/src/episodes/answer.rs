//! How a joint answers its command in all episodes: how late, and how far apart the positions of both directions are.

use super::moments::{CONSTANT, Rows, moments, running, taps};
use super::scale::median;
use super::series::Joint;
use crate::thresholds::{EPISODE_RIDGE, PLAUSIBLE_SUM};

/// The answer of all episodes.
#[derive(Debug)]
pub(super) struct Answer {
    /// Mean time from a command to what follows \[s\]: the taps' first moment over their sum.
    pub(super) after_s: f64,
    /// Median of what the taps leave while the command falls, less that while it rises.
    pub(super) hysteresis: f64,
}

/// None of a joint that does not follow its command.
pub(super) fn of(joint: &Joint) -> Option<Answer> {
    let all = running(&moments(joint)).pop()?;
    let columns: Vec<usize> = std::iter::once(CONSTANT).chain(taps()).collect();
    let fit = all.solve(&columns, |column| {
        EPISODE_RIDGE * all.product(column, column)
    });
    let weights = fit.coefficients();
    let (sum, moment) = (weights[1..].iter().enumerate())
        .fold((0.0, 0.0), |(sum, moment), (lag, tap)| {
            (sum + tap, moment + lag as f64 * tap)
        });
    let after_s = moment / sum * joint.step_s;
    if !PLAUSIBLE_SUM.contains(&sum) || after_s.is_nan() || after_s < 0.0 {
        return None;
    }
    let (mut rising, mut falling) = (Vec::new(), Vec::new());
    let rows = Rows::new(joint);
    for place in 0..joint.episodes.len() {
        rows.each(place, |values| {
            let known = columns
                .iter()
                .zip(weights)
                .map(|(column, weight)| values[*column] * weight);
            let left = values[values.len() - 1] - known.sum::<f64>();
            // the newest tap less the oldest: which way the command goes
            match values[taps().start] - values[taps().end - 1] {
                change if change > 0.0 => rising.push(left),
                change if change < 0.0 => falling.push(left),
                _ => {}
            }
        });
    }
    Some(Answer {
        after_s,
        hysteresis: (median(&mut falling) - median(&mut rising)).max(0.0),
    })
}
