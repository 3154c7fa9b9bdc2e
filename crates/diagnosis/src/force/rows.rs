//! Rows of the torques' least squares: whitened block means channel by channel, one for each number that is known
//! beforehand, and what changes within blocks.

use std::ops::Range;

use nalgebra::{Cholesky, DMatrix};

use super::fast::FastRows;
use crate::engine::layout::Layout;
use crate::engine::system::Column;

/// What whitens blocks: the Cholesky factors of the covariances of their mean torques.
#[derive(Debug, Clone)]
pub(super) struct Whitener {
    channels: usize,
    pub(super) blocks: usize,
    /// Entries (row, column) one after the other, each for all blocks.
    factor: Vec<f64>,
}

impl Whitener {
    /// From each block's covariance; none for one that is not positive.
    pub(super) fn new(channels: usize, covariances: Vec<DMatrix<f64>>) -> Option<Self> {
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
    pub(super) fn whiten(&self, values: &[f64]) -> Vec<f64> {
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
    pub(super) fn colour(&self, white: &[f64]) -> Vec<f64> {
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

/// The rows.
#[derive(Debug, Clone)]
pub(super) struct TorqueRows {
    pub(super) whitener: Whitener,
    /// Numbers that are known beforehand.
    priors: usize,
    /// Per channel; empty before the base model is fitted.
    fast: Vec<FastRows>,
}

impl Layout for TorqueRows {
    const SURVIVING: f64 = 1e-6;

    fn count(&self) -> usize {
        let fast: usize = self.fast.iter().map(FastRows::len).sum();
        self.whitener.channels * self.whitener.blocks + self.priors + fast
    }

    fn range(&self, stream: usize) -> Range<usize> {
        let Whitener {
            channels, blocks, ..
        } = self.whitener;
        let ends = channels * blocks;
        let Some(channel) = stream.checked_sub(channels + 1) else {
            return match stream == channels {
                true => ends..ends + self.priors,
                false => stream * blocks..(stream + 1) * blocks,
            };
        };
        let before = self.fast[..channel].iter().map(FastRows::len);
        let first = ends + self.priors + before.sum::<usize>();
        first..first + self.fast[channel].len()
    }
}

impl TorqueRows {
    pub(super) fn new(whitener: Whitener, priors: usize) -> Self {
        Self {
            whitener,
            priors,
            fast: Vec::new(),
        }
    }

    /// Adds what changes within blocks; their readings.
    pub(super) fn append(&mut self, fast: Vec<FastRows>) -> Vec<f64> {
        self.fast = fast;
        let readings = self.fast.iter().flat_map(|own| own.reading.iter().copied());
        readings.collect()
    }

    /// The row of a number that is known beforehand.
    pub(super) fn prior(&self, index: usize) -> usize {
        self.whitener.channels * self.whitener.blocks + index
    }

    /// Rows of what changes within blocks.
    pub(super) fn within_blocks(&self) -> Range<usize> {
        self.prior(self.priors)..self.count()
    }

    /// Column of block means, channel after channel.
    pub(super) fn of_means(&self, means: &[f64]) -> Column {
        let white = self.whitener.whiten(means);
        let channels = white.chunks_exact(self.whitener.blocks).enumerate();
        let parts = channels
            .filter(|(_, own)| own.iter().any(|entry| *entry != 0.0))
            .map(|(channel, own)| (channel, own.to_vec()));
        Column {
            parts: parts.collect(),
        }
    }

    /// A vector over all rows as a column.
    pub(super) fn split(&self, dense: &[f64]) -> Column {
        let streams = 0..self.whitener.channels + 1 + self.fast.len();
        let parts = streams.map(|stream| (stream, dense[self.range(stream)].to_vec()));
        Column {
            parts: parts.collect(),
        }
    }

    /// Column with nothing but an entry in one prior's row: it sets that number free.
    pub(super) fn release(&self, index: usize, weight: f64) -> Column {
        let mut row = vec![0.0; self.priors];
        row[index] = weight;
        Column {
            parts: vec![(self.whitener.channels, row)],
        }
    }

    /// A harmonic's part within the blocks of its channel.
    pub(super) fn fast(&self, channel: usize, harmonic: usize) -> Option<(usize, Vec<f64>)> {
        let own = self.fast.get(channel)?.column(harmonic);
        Some((self.whitener.channels + 1 + channel, own))
    }

    /// Windows of the block means of each channel, from those of the blocks.
    pub(super) fn windows(&self, blocks: &[Range<usize>]) -> Vec<Vec<Range<usize>>> {
        (0..self.whitener.channels)
            .map(|channel| {
                let first = channel * self.whitener.blocks;
                let shifted = |window: &Range<usize>| first + window.start..first + window.end;
                blocks.iter().map(shifted).collect()
            })
            .collect()
    }
}
