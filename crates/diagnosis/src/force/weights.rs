//! What whitens blocks: the inverse covariances of their mean torques.

use nalgebra::{Cholesky, DMatrix};

/// Inverse covariances of the blocks, channel by channel.
#[derive(Debug)]
pub(super) struct Weights {
    channels: usize,
    pub(super) blocks: usize,
    /// Entries (to, from) one after the other, each for all blocks.
    inverse: Vec<f64>,
    /// The same of the inverse Cholesky factors: what whitens a block.
    whitener: Vec<f64>,
}

impl Weights {
    /// From each block's covariance; none for one that is not positive.
    pub(super) fn new(channels: usize, covariances: Vec<DMatrix<f64>>) -> Option<Self> {
        let blocks = covariances.len();
        let mut inverse = vec![0.0; channels * channels * blocks];
        let mut whitener = inverse.clone();
        for (block, covariance) in covariances.into_iter().enumerate() {
            let lower = Cholesky::new(covariance)?.l();
            let white = lower.solve_lower_triangular(&DMatrix::identity(channels, channels))?;
            let whole = white.tr_mul(&white);
            for to in 0..channels {
                for from in 0..channels {
                    let place = (to * channels + from) * blocks + block;
                    inverse[place] = whole[(to, from)];
                    whitener[place] = white[(to, from)];
                }
            }
        }
        Some(Self {
            channels,
            blocks,
            inverse,
            whitener,
        })
    }

    fn apply(&self, entries: &[f64], values: &[f64]) -> Vec<f64> {
        let blocks = self.blocks;
        let mut out = vec![0.0; values.len()];
        for to in 0..self.channels {
            let sums = &mut out[to * blocks..(to + 1) * blocks];
            for from in 0..self.channels {
                let first = (to * self.channels + from) * blocks;
                let entries = &entries[first..first + blocks];
                let values = &values[from * blocks..(from + 1) * blocks];
                for ((sum, entry), value) in sums.iter_mut().zip(entries).zip(values) {
                    *sum += entry * value;
                }
            }
        }
        out
    }

    /// Values (channel after channel) times the inverse covariance.
    pub(super) fn weigh(&self, values: &[f64]) -> Vec<f64> {
        self.apply(&self.inverse, values)
    }

    /// Values made white with unit deviation.
    pub(super) fn whiten(&self, values: &[f64]) -> Vec<f64> {
        self.apply(&self.whitener, values)
    }

    /// Entry of a block's inverse covariance.
    pub(super) fn entry(&self, to: usize, from: usize, block: usize) -> f64 {
        self.inverse[(to * self.channels + from) * self.blocks + block]
    }

    /// Product of two series of one channel.
    pub(super) fn own(&self, channel: usize, a: &[f64], b: &[f64]) -> f64 {
        let first = channel * (self.channels + 1) * self.blocks;
        let inverse = &self.inverse[first..first + self.blocks];
        a.iter()
            .zip(b)
            .zip(inverse)
            .map(|((a, b), entry)| a * b * entry)
            .sum()
    }
}
