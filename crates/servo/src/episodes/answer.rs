//! How a joint answers its command in all episodes: whether it follows it, in which unit, and how late.

use haptical_linalg::NormalEquations;

use super::moments::{COLUMNS, CONSTANT, moments, taps};
use super::series::Joint;
use crate::thresholds::{EPISODE_RIDGE, FOLLOWED_SHARE, LEAST_SUM, PLAUSIBLE_SUM};

/// The answer of all episodes.
#[derive(Debug)]
pub(super) struct Answer {
    /// Sum of the taps: the position's changes over the command's.
    pub(super) sum: f64,
    /// Share of the position's squares within the episodes that the taps explain.
    pub(super) share: f64,
    /// Mean time from a command to what follows \[s\]: the taps' first moment over their sum.
    pub(super) after_s: f64,
}

impl Answer {
    /// Whether the position follows the command at all.
    pub(super) fn follows(&self) -> bool {
        self.share >= FOLLOWED_SHARE && self.sum >= LEAST_SUM
    }

    /// Whether both are in one unit.
    pub(super) fn is_in_unit(&self) -> bool {
        PLAUSIBLE_SUM.contains(&self.sum)
    }
}

/// None of a joint or a command without motion.
pub(super) fn of(joint: &Joint) -> Option<Answer> {
    let mut within = NormalEquations::new(COLUMNS);
    for episode in moments(joint) {
        within.add(&centred(&episode), 1.0);
    }
    let columns: Vec<usize> = taps().collect();
    let fit = within.solve(&columns, |column| {
        EPISODE_RIDGE * within.product(column, column)
    });
    let weights = fit.coefficients();
    let (sum, moment) = (weights.iter().enumerate())
        .fold((0.0, 0.0), |(sum, moment), (lag, tap)| {
            (sum + tap, moment + lag as f64 * tap)
        });
    let share = fit.explained() / within.target_square();
    let after_s = moment / sum * joint.step_s;
    if !share.is_finite() || !sum.is_finite() {
        return None;
    }
    Some(Answer {
        sum,
        share,
        after_s,
    })
}

/// Products about the means of an episode.
fn centred(sums: &NormalEquations) -> NormalEquations {
    let rows = sums.product(CONSTANT, CONSTANT).max(1.0);
    NormalEquations::from_products(COLUMNS, |a, b| {
        sums.product(a, b) - sums.product(a, CONSTANT) * sums.product(b, CONSTANT) / rows
    })
}
