//! Slow energy of what a model of the torques leaves: what noise does not account for is structure.

use std::ops::Range;

use super::normal::Normal;
use super::recorded::Recorded;
use super::weights::Weights;

/// Blocks of a window, within which what is left of a gap hardly changes.
const WINDOW: usize = 4;

/// Slow energy per channel.
#[derive(Debug, Clone)]
pub(super) struct Energy {
    pub(super) sum: Vec<f64>,
    /// Its expectation under noise.
    pub(super) freedom: Vec<f64>,
}

impl Energy {
    /// Of the residuals that a solution leaves. `free` directions of each window can take
    /// any torque, and carry no energy.
    pub(super) fn of(
        recorded: &Recorded<'_>,
        weights: &Weights,
        normal: &Normal<'_>,
        rest: &[f64],
        free: usize,
    ) -> Self {
        let windows = windows(recorded);
        let channels = recorded.channels.len();
        let blocks = recorded.blocks.len();
        let slow = |values: &[f64]| -> Vec<f64> {
            let white = weights.whiten(values);
            let mut sums = Vec::with_capacity(channels * windows.len());
            for channel in 0..channels {
                let own = &white[channel * blocks..(channel + 1) * blocks];
                sums.extend(windows.iter().map(|window| {
                    own[window.clone()].iter().sum::<f64>() / (window.len() as f64).sqrt()
                }));
            }
            sums
        };
        let sums = slow(rest);
        let count = windows.len();
        let square = |channel: usize| {
            let own = &sums[channel * count..(channel + 1) * count];
            own.iter().map(|value| value * value).sum::<f64>()
        };
        let leverage = normal.leverage(slow);
        let freedom = |channel: usize| {
            let range = channel * count..(channel + 1) * count;
            let taken = leverage.as_ref().map_or(0.0, |matrix| {
                range
                    .map(|row| matrix.column(row).norm_squared())
                    .sum::<f64>()
            });
            (count as f64 * (1.0 - free as f64 / channels as f64) - taken).max(0.0)
        };
        Self {
            sum: (0..channels).map(square).collect(),
            freedom: (0..channels).map(freedom).collect(),
        }
    }

    /// What noise does not account for, all channels together.
    pub(super) fn excess(&self) -> f64 {
        let sum: f64 = self.sum.iter().sum();
        sum - self.freedom.iter().sum::<f64>()
    }

    /// Standard deviations by which the energy exceeds that of noise.
    pub(super) fn deviations(&self) -> f64 {
        let freedom: f64 = self.freedom.iter().sum();
        if freedom > 0.0 {
            self.excess() / (2.0 * freedom).sqrt()
        } else {
            0.0
        }
    }

    /// Energy over that of noise, at least 1.
    pub(super) fn dispersion(&self) -> f64 {
        let freedom: f64 = self.freedom.iter().sum();
        if freedom > 0.0 {
            (self.sum.iter().sum::<f64>() / freedom).max(1.0)
        } else {
            1.0
        }
    }
}

/// Windows of blocks that follow each other.
fn windows(recorded: &Recorded<'_>) -> Vec<Range<usize>> {
    let mut windows = Vec::new();
    let mut start = 0;
    for block in 0..recorded.blocks.len() {
        let next = block + 1;
        let breaks = recorded.blocks.get(next).is_none_or(|next| !next.follows);
        if breaks || next - start == WINDOW {
            windows.push(start..next);
            start = next;
        }
    }
    windows
}
