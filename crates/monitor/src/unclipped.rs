//! How far readings are that count as less than they were: medians of blocks, which single wild readings do not move.

use std::collections::VecDeque;

use crate::monitor::{RING_BLOCKS, median};

/// Share of readings beyond the farthest one from which on they are no single ones, and say how far the component moved.
const NOT_SINGLE: f64 = 0.05;

/// Medians of the blocks kept.
#[derive(Debug, Clone)]
pub(crate) struct Unclipped {
    /// Of the open block, as read, in scales: of each component.
    open: Vec<Vec<f64>>,
    /// Of each block and component: median, share of readings beyond the farthest one, and the reading farthest out.
    ring: VecDeque<[f64; 3]>,
    farthest: f64,
}

/// Where a component is beyond what counts, in scales.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Beyond {
    pub(crate) mean: f64,
    /// Standard deviation of the mean, of blocks that are independent.
    pub(crate) sd: f64,
    /// Root mean square of the medians.
    pub(crate) rms: f64,
}

impl Unclipped {
    pub(crate) fn new(components: usize, farthest: f64) -> Self {
        Self {
            open: vec![Vec::new(); components],
            ring: VecDeque::with_capacity(components * RING_BLOCKS),
            farthest,
        }
    }

    /// Makes room for blocks of so many rows.
    pub(crate) fn reserve(&mut self, rows: usize) {
        self.open
            .iter_mut()
            .for_each(|open| open.reserve_exact(rows));
    }

    pub(crate) fn push(&mut self, component: usize, reading: f64) {
        if reading.is_finite()
            && let Some(open) = self.open.get_mut(component)
        {
            open.push(reading);
        }
    }

    pub(crate) fn close_block(&mut self) {
        let width = self.open.len();
        if self.ring.len() == width * RING_BLOCKS {
            self.ring.drain(..width);
        }
        for open in &mut self.open {
            let beyond = open.iter().filter(|own| own.abs() > self.farthest).count();
            let share = beyond as f64 / open.len().max(1) as f64;
            let middle = match open.is_empty() {
                true => f64::NAN,
                false => median(open),
            };
            let extreme =
                open.iter().copied().fold(
                    0.0,
                    |most: f64, own| {
                        if own.abs() > most.abs() { own } else { most }
                    },
                );
            self.ring.push_back([middle, share, extreme]);
            open.clear();
        }
    }

    /// A component from a block of the ring on, where its readings are beyond what counts.
    pub(crate) fn beyond(&self, component: usize, since: usize) -> Option<Beyond> {
        let width = self.open.len().max(1);
        let own = self.ring.iter().skip(since * width + component);
        let own: Vec<[f64; 3]> = own
            .step_by(width)
            .filter(|block| block[0].is_finite())
            .copied()
            .collect();
        let count = own.len() as f64;
        let mean_of = |value: fn(&[f64; 3]) -> f64| own.iter().map(value).sum::<f64>() / count;
        if own.is_empty() || mean_of(|block| block[1]) < NOT_SINGLE {
            return None;
        }
        let mean = mean_of(|block| block[0]);
        let square = mean_of(|block| block[0] * block[0]);
        let variance = (square - mean * mean).max(0.0) * count / (count - 1.0).max(1.0);
        Some(Beyond {
            mean,
            sd: (variance / count).sqrt(),
            rms: square.sqrt(),
        })
    }

    /// The reading of a block that is farthest out, in scales.
    pub(crate) fn extreme(&self, component: usize, block: usize) -> Option<f64> {
        let own = self.ring.get(block * self.open.len() + component);
        own.map(|block| block[2])
    }

    /// Numbers held.
    pub(crate) fn numbers_held(&self) -> usize {
        let open: usize = self.open.iter().map(Vec::capacity).sum();
        3 * self.ring.capacity() + open
    }
}
