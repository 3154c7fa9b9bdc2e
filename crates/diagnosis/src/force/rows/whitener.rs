//! Block means made white.

use nalgebra::{Cholesky, DMatrix};

/// What whitens blocks: the Cholesky factors of the covariances of their mean torques.
#[derive(Debug, Clone)]
pub(crate) struct Whitener {
    pub(crate) channels: usize,
    pub(crate) blocks: usize,
    /// Entries (row, column) one after the other, each for all blocks.
    factor: Vec<f64>,
}

impl Whitener {
    /// From each block's covariance; none for one that is not positive.
    pub(crate) fn new(channels: usize, covariances: Vec<DMatrix<f64>>) -> Option<Self> {
        let blocks = covariances.len();
        let mut factor = vec![0.0; channels * channels * blocks];
        for (block, covariance) in covariances.into_iter().enumerate() {
            let lower = Cholesky::new(covariance)?.l();
            for row in 0..channels {
                for column in 0..=row {
                    factor[(row * channels + column) * blocks + block] = lower[(row, column)];
                }
            }
        }
        Some(Self {
            channels,
            blocks,
            factor,
        })
    }

    fn entries(&self, row: usize, column: usize) -> &[f64] {
        let first = (row * self.channels + column) * self.blocks;
        &self.factor[first..first + self.blocks]
    }

    /// Values (channel after channel) made white with unit deviation.
    pub(crate) fn whiten(&self, values: &[f64]) -> Vec<f64> {
        let mut white = values.to_vec();
        for row in 0..self.channels {
            let (before, own) = white.split_at_mut(row * self.blocks);
            let own = &mut own[..self.blocks];
            for (column, other) in before.chunks_exact(self.blocks).enumerate() {
                let entries = self.entries(row, column).iter().zip(other);
                for (sum, (entry, other)) in own.iter_mut().zip(entries) {
                    *sum -= entry * other;
                }
            }
            for (value, entry) in own.iter_mut().zip(self.entries(row, row)) {
                *value /= entry;
            }
        }
        white
    }

    /// The inverse of [`Self::whiten`].
    pub(crate) fn colour(&self, white: &[f64]) -> Vec<f64> {
        let mut values = vec![0.0; self.channels * self.blocks];
        for (row, own) in values.chunks_exact_mut(self.blocks).enumerate() {
            for (column, other) in white.chunks_exact(self.blocks).enumerate().take(row + 1) {
                let entries = self.entries(row, column).iter().zip(other);
                for (sum, (entry, other)) in own.iter_mut().zip(entries) {
                    *sum += entry * other;
                }
            }
        }
        values
    }
}
