//! Rows of the torques' least squares: whitened block means channel by channel, one for each number that is known
//! beforehand, and what changes within blocks.

pub(crate) mod fast;
pub(crate) mod harmonics;
pub(crate) mod whitener;

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use self::whitener::Whitener;
use crate::engine::layout::Layout;
use crate::engine::system::Column;
use crate::thresholds::torque::{ABSENT_HARMONIC, SURVIVING};

/// What the rows of a channel say of its harmonics within blocks: as many independent readings.
#[derive(Debug, Clone)]
pub(crate) struct FastRows {
    /// One column for each harmonic.
    root: DMatrix<f64>,
    pub(crate) reading: Vec<f64>,
}

impl FastRows {
    /// A square root of the harmonics' normal matrix, with the reading that belongs to its right side.
    pub(crate) fn new(gram: DMatrix<f64>, right: &DVector<f64>) -> Self {
        let eigen = gram.symmetric_eigen();
        let largest = eigen.eigenvalues.max().max(0.0);
        let kept: Vec<usize> = (0..right.len())
            .filter(|&k| eigen.eigenvalues[k] > ABSENT_HARMONIC * largest)
            .collect();
        let size = |k: usize| eigen.eigenvalues[k].sqrt();
        let direction = |k: usize| eigen.eigenvectors.column(k);
        Self {
            root: DMatrix::from_fn(kept.len(), right.len(), |row, column| {
                size(kept[row]) * direction(kept[row])[column]
            }),
            reading: kept
                .iter()
                .map(|&k| direction(k).dot(right) / size(k))
                .collect(),
        }
    }

    fn len(&self) -> usize {
        self.reading.len()
    }

    fn column(&self, harmonic: usize) -> Vec<f64> {
        self.root.column(harmonic).iter().copied().collect()
    }
}

/// The rows.
#[derive(Debug, Clone)]
pub(crate) struct TorqueRows {
    pub(crate) whitener: Whitener,
    /// Numbers that are known beforehand.
    priors: usize,
    /// Per channel; empty before the base model is fitted.
    fast: Vec<FastRows>,
}

impl Layout for TorqueRows {
    const SURVIVING: f64 = SURVIVING;

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
    pub(crate) fn new(whitener: Whitener, priors: usize) -> Self {
        Self {
            whitener,
            priors,
            fast: Vec::new(),
        }
    }

    /// Adds what changes within blocks; their readings.
    pub(crate) fn append(&mut self, fast: Vec<FastRows>) -> Vec<f64> {
        self.fast = fast;
        let readings = self.fast.iter().flat_map(|own| own.reading.iter().copied());
        readings.collect()
    }

    /// The row of a number that is known beforehand.
    pub(crate) fn prior(&self, index: usize) -> usize {
        self.whitener.channels * self.whitener.blocks + index
    }

    /// Rows of what changes within blocks.
    pub(crate) fn within_blocks(&self) -> Range<usize> {
        self.prior(self.priors)..self.count()
    }

    /// Column of block means, channel after channel.
    pub(crate) fn of_means(&self, means: &[f64]) -> Column {
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
    pub(crate) fn split(&self, dense: &[f64]) -> Column {
        let streams = 0..self.whitener.channels + 1 + self.fast.len();
        let parts = streams.map(|stream| (stream, dense[self.range(stream)].to_vec()));
        Column {
            parts: parts.collect(),
        }
    }

    /// Column with nothing but an entry in one prior's row: it sets that number free.
    pub(crate) fn release(&self, index: usize, weight: f64) -> Column {
        let mut row = vec![0.0; self.priors];
        row[index] = weight;
        Column {
            parts: vec![(self.whitener.channels, row)],
        }
    }

    /// A harmonic's part within the blocks of its channel.
    pub(crate) fn fast(&self, channel: usize, harmonic: usize) -> Option<(usize, Vec<f64>)> {
        let own = self.fast.get(channel)?.column(harmonic);
        Some((self.whitener.channels + 1 + channel, own))
    }

    /// Windows of the block means of each channel, from those of the blocks.
    pub(crate) fn windows(&self, blocks: &[Range<usize>]) -> Vec<Vec<Range<usize>>> {
        (0..self.whitener.channels)
            .map(|channel| {
                let first = channel * self.whitener.blocks;
                let shifted = |window: &Range<usize>| first + window.start..first + window.end;
                blocks.iter().map(shifted).collect()
            })
            .collect()
    }
}
