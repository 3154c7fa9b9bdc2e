//! Columns of effects, and tables of what they have beyond the blocks' means.

use nalgebra::{DMatrix, DVector};

/// Values of one column.
#[derive(Debug, Clone)]
pub(super) enum Values {
    /// Channel after channel, block after block.
    All(Vec<f64>),
    /// One channel's blocks; nothing elsewhere.
    Channel(usize, Vec<f64>),
    /// Nothing but in one base column's prior: it sets that column free.
    Release(usize),
}

/// A column with what it has beyond the blocks' means: products within blocks.
#[derive(Debug, Clone)]
pub(super) struct Term {
    pub(super) values: Values,
    /// Entry of the channel's table of fast columns.
    pub(super) fast: Option<Fast>,
}

/// Place of a column among the fast columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Fast {
    pub(super) channel: usize,
    pub(super) index: usize,
}

impl From<Values> for Term {
    fn from(values: Values) -> Self {
        Self { values, fast: None }
    }
}

/// Products of fast columns (deviations from block means) over their noise, per channel.
#[derive(Debug, Default)]
pub(super) struct FastTable {
    pub(super) gram: Vec<DMatrix<f64>>,
    pub(super) right: Vec<DVector<f64>>,
}

impl FastTable {
    pub(super) fn product(&self, a: Option<Fast>, b: Option<Fast>) -> f64 {
        match (a, b) {
            (Some(a), Some(b)) if a.channel == b.channel => {
                self.gram[a.channel][(a.index, b.index)]
            }
            _ => 0.0,
        }
    }

    pub(super) fn right(&self, a: Option<Fast>) -> f64 {
        a.map_or(0.0, |a| self.right[a.channel][a.index])
    }
}
