//! Rows of the torques' least squares: whitened block means by channel, a row for each number known beforehand, and
//! what changes within blocks.

use std::ops::Range;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::Means;
use crate::engine::{Column, Layout};
use crate::thresholds::torque::{ABSENT_HARMONIC, SURVIVING};

/// What whitens blocks: lower Cholesky factors of the covariances of their mean torques.
#[derive(Debug, Clone)]
pub(super) struct Whitener(Vec<DMatrix<f64>>);

impl Whitener {
    /// Factors each block's covariance; none where one is not positive definite.
    pub(super) fn new(covariances: impl Iterator<Item = DMatrix<f64>>) -> Option<Self> {
        let factors = covariances.map(|covariance| {
            Cholesky::new(covariance).map(|factor: Cholesky<f64, Dyn>| factor.l())
        });
        Some(Self(factors.collect::<Option<_>>()?))
    }

    pub(super) fn factor(&self, block: usize) -> &DMatrix<f64> {
        &self.0[block]
    }

    /// Block means made white with unit deviation.
    pub(super) fn whiten(&self, means: &Means) -> Means {
        let mut white = means.clone();
        for (block, factor) in self.0.iter().enumerate() {
            for channel in 0..white.ncols() {
                for before in 0..channel {
                    white[(block, channel)] -= factor[(channel, before)] * white[(block, before)];
                }
                white[(block, channel)] /= factor[(channel, channel)];
            }
        }
        white
    }

    /// The inverse of [`Self::whiten`].
    fn colour(&self, white: &Means) -> Means {
        let mut means = white.clone();
        for (factor, mut block) in self.0.iter().zip(means.row_iter_mut()) {
            block.copy_from(&(factor * block.transpose()).transpose());
        }
        means
    }
}

/// What the rows of a channel say of its harmonics within blocks, as independent readings.
#[derive(Debug, Clone)]
pub(super) struct FastRows {
    /// One column for each harmonic.
    root: DMatrix<f64>,
    reading: DVector<f64>,
}

impl FastRows {
    /// A square root of the harmonics' normal matrix, with the reading that belongs to its right side.
    pub(super) fn new(gram: DMatrix<f64>, right: &DVector<f64>) -> Self {
        let eigen = gram.symmetric_eigen();
        let least = ABSENT_HARMONIC * eigen.eigenvalues.max().max(0.0);
        let all = 0..right.len();
        let kept: Vec<usize> = all.filter(|&k| eigen.eigenvalues[k] > least).collect();
        let directions = eigen.eigenvectors.select_columns(&kept);
        let sizes = eigen.eigenvalues.select_rows(&kept).map(f64::sqrt);
        Self {
            reading: directions.tr_mul(right).component_div(&sizes),
            root: DMatrix::from_diagonal(&sizes) * directions.transpose(),
        }
    }
}

/// Rows of the torques' least squares.
#[derive(Debug, Clone)]
pub(super) struct TorqueRows {
    pub(super) whitener: Whitener,
    /// Blocks and channels.
    shape: (usize, usize),
    /// Numbers that are known beforehand.
    priors: usize,
    /// Per channel; empty before the base model is fitted.
    fast: Vec<FastRows>,
}

impl Layout for TorqueRows {
    const SURVIVING: f64 = SURVIVING;

    fn count(&self) -> usize {
        self.range(self.shape.1 + self.fast.len()).end
    }

    fn range(&self, stream: usize) -> Range<usize> {
        let (blocks, channels) = self.shape;
        let Some(channel) = stream.checked_sub(channels) else {
            return stream * blocks..(stream + 1) * blocks;
        };
        let lengths = self.fast.iter().map(|rows| rows.reading.len());
        let mut ends = std::iter::once(self.priors).chain(lengths);
        let first = blocks * channels + ends.by_ref().take(channel).sum::<usize>();
        first..first + ends.next().unwrap_or(0)
    }
}

impl TorqueRows {
    pub(super) fn new(whitener: Whitener, shape: (usize, usize), priors: usize) -> Self {
        Self {
            whitener,
            shape,
            priors,
            fast: Vec::new(),
        }
    }

    /// Adds what changes within blocks and returns its readings.
    pub(super) fn append(&mut self, fast: Vec<FastRows>) -> Vec<f64> {
        self.fast = fast;
        let readings = self.fast.iter().flat_map(|rows| rows.reading.iter());
        readings.copied().collect()
    }

    /// The row of a number that is known beforehand.
    pub(super) fn prior(&self, index: usize) -> usize {
        self.shape.0 * self.shape.1 + index
    }

    /// Rows of what changes within blocks.
    pub(super) fn within_blocks(&self) -> Range<usize> {
        self.prior(self.priors)..self.count()
    }

    /// Block means from their whitened rows.
    pub(super) fn means(&self, rows: &[f64]) -> Means {
        let (blocks, channels) = self.shape;
        let white = Means::from_column_slice(blocks, channels, &rows[..blocks * channels]);
        self.whitener.colour(&white)
    }

    /// Column of block means, zero in all other rows.
    pub(super) fn of_means(&self, means: &Means) -> Vec<f64> {
        let mut column = self.whitener.whiten(means).as_slice().to_vec();
        column.resize(self.count(), 0.0);
        column
    }

    /// A column whose one entry is in a prior's row: it sets that number free.
    pub(super) fn release(&self, index: usize, weight: f64) -> Vec<f64> {
        let mut column = vec![0.0; self.count()];
        column[self.prior(index)] = weight;
        column
    }

    /// Adds a harmonic's part within the blocks of its channel to a column.
    pub(super) fn add_fast(&self, channel: usize, harmonic: usize, column: &mut [f64]) {
        if let Some(fast) = self.fast.get(channel) {
            let rows = &mut column[self.range(self.shape.1 + 1 + channel)];
            rows.copy_from_slice(fast.root.column(harmonic).as_slice());
        }
    }

    /// Splits a column by streams and leaves out those where it is zero.
    pub(super) fn split(&self, column: &[f64]) -> Column {
        let streams = 0..=self.shape.1 + self.fast.len();
        let parts = streams.map(|stream| (stream, column[self.range(stream)].to_vec()));
        let parts = parts.filter(|(_, entries)| entries.iter().any(|entry| *entry != 0.0));
        Column {
            parts: parts.collect(),
        }
    }
}
