//! Least squares on some columns of a comparison, judged on blocks that the fit did not see.
//!
//! Normal equations per fold and channel are formed once; every hypothesis is then a small system of them. A channel weighs
//! by what the fullest hypothesis leaves of it, so that torques which no hypothesis describes do not drown the others.

use nalgebra::{Cholesky, DMatrix, DVector};
use rayon::prelude::*;

use super::blocks::Pair;
use super::columns::Columns;
use crate::thresholds::payload::{FOLDS, LEAST_GAIN, LEAST_SHARE_OF_FOLDS, LEAST_T, RIDGE};

/// Normal equations of the rows of one fold and channel.
#[derive(Debug, Clone)]
struct Normal {
    gram: DMatrix<f64>,
    right: DVector<f64>,
    square: f64,
    rows: f64,
}

/// The rows of a comparison in folds of blocks that follow each other.
#[derive(Debug)]
pub(in crate::force) struct Folds {
    /// Per fold, per channel.
    parts: Vec<Vec<Normal>>,
    /// Length of each column, and the standard deviation that its number is known to have.
    length: Vec<f64>,
    sd: Vec<f64>,
    /// One over the variance of a block's reading, per channel.
    pub(in crate::force) weight: Vec<f64>,
}

/// A hypothesis fitted: its numbers, and what it leaves of unseen blocks.
#[derive(Debug, Clone)]
pub(in crate::force) struct Fitted {
    /// Places of its columns.
    pub(in crate::force) columns: Vec<usize>,
    pub(super) numbers: Vec<f64>,
    /// The same without each fold.
    pub(super) without: Vec<Vec<f64>>,
    /// Weighted squares left of each fold, channel by channel.
    pub(super) left: Vec<Vec<f64>>,
}

/// What one hypothesis leaves less than another on unseen blocks.
#[derive(Debug, Clone, Copy)]
pub(in crate::force) struct Gain {
    /// In squares over the variance of a block.
    pub(in crate::force) sum: f64,
    /// Mean over folds, over its standard error.
    pub(super) t: f64,
    /// Share of the folds that gain.
    pub(super) share: f64,
}

impl Gain {
    pub(in crate::force) fn is_beyond_chance(self) -> bool {
        // a gain that one fold has most of has a large standard error; that all ten have one is chance once in a thousand
        let is_steady = self.t >= LEAST_T || self.share >= 1.0;
        self.sum >= LEAST_GAIN && is_steady && self.share >= LEAST_SHARE_OF_FOLDS
    }
}

impl Folds {
    /// `least`: variances that blocks have by noise alone, channel by channel.
    pub(in crate::force) fn new(columns: &Columns, pair: &Pair, least: &[f64]) -> Self {
        let fold_of = folds(pair);
        let channels = pair.reading.len();
        let places: Vec<(usize, usize)> = (0..FOLDS)
            .flat_map(|fold| (0..channels).map(move |channel| (fold, channel)))
            .collect();
        let normal = |&(fold, channel): &(usize, usize)| {
            let rows: Vec<usize> = (0..fold_of.len())
                .filter(|&row| fold_of[row] == fold)
                .collect();
            normal(columns, &pair.reading[channel], channel, &rows)
        };
        let all: Vec<Normal> = places.par_iter().map(normal).collect();
        let parts: Vec<Vec<Normal>> = all
            .chunks(channels.max(1))
            .map(<[Normal]>::to_vec)
            .collect();
        let mut folds = Self {
            parts,
            length: Vec::new(),
            sd: columns.sd.clone(),
            weight: vec![1.0; channels],
        };
        folds.weigh(least);
        folds
    }

    /// Weights by what all columns together leave of each channel.
    fn weigh(&mut self, least: &[f64]) {
        let channels = self.weight.len();
        for channel in 0..channels {
            let (mut square, mut rows) = (0.0, 0.0);
            for parts in &self.parts {
                square += parts[channel].square;
                rows += parts[channel].rows;
            }
            self.weight[channel] = 1.0 / (square / rows.max(1.0)).max(least[channel]).max(1e-300);
        }
        let every: Vec<usize> = (0..self.sd.len()).collect();
        for _ in 0..2 {
            self.measure();
            let numbers = self.solve(&every, None);
            for channel in 0..channels {
                let (mut square, mut rows) = (0.0, 0.0);
                for parts in &self.parts {
                    square += parts[channel].left(&every, &numbers);
                    rows += parts[channel].rows;
                }
                let variance = (square / rows.max(1.0)).max(least[channel]).max(1e-300);
                self.weight[channel] = 1.0 / variance;
            }
        }
        self.measure();
    }

    /// Lengths of the weighted columns.
    fn measure(&mut self) {
        let square = |column: usize| {
            let parts = self
                .parts
                .iter()
                .flat_map(|parts| parts.iter().zip(&self.weight));
            parts
                .map(|(part, weight)| weight * part.gram[(column, column)])
                .sum::<f64>()
        };
        self.length = (0..self.sd.len())
            .map(|column| square(column).sqrt())
            .collect();
    }

    /// Numbers of the columns, one fold left out.
    fn solve(&self, columns: &[usize], without: Option<usize>) -> Vec<f64> {
        let count = columns.len();
        let mut gram = DMatrix::<f64>::zeros(count, count);
        let mut right = DVector::<f64>::zeros(count);
        for (fold, parts) in self.parts.iter().enumerate() {
            if Some(fold) == without {
                continue;
            }
            for (part, weight) in parts.iter().zip(&self.weight) {
                for (b, &column) in columns.iter().enumerate() {
                    right[b] += weight * part.right[column];
                    for (a, &row) in columns.iter().enumerate().skip(b) {
                        gram[(a, b)] += weight * part.gram[(row, column)];
                    }
                }
            }
        }
        let length: Vec<f64> = columns
            .iter()
            .map(|&column| self.length[column].max(1e-150))
            .collect();
        for b in 0..count {
            right[b] /= length[b];
            for a in b..count {
                gram[(a, b)] /= length[a] * length[b];
            }
            // what is known of a number beforehand, and of those that only sums of which show a smallest solution
            gram[(b, b)] += RIDGE + (1.0 / (self.sd[columns[b]] * length[b])).powi(2);
        }
        gram.fill_upper_triangle_with_lower_triangle();
        let solved = Cholesky::new(gram).map(|factor| factor.solve(&right));
        let solved = solved.unwrap_or_else(|| DVector::zeros(count));
        solved
            .iter()
            .zip(&length)
            .map(|(value, length)| value / length)
            .collect()
    }

    /// Fits a hypothesis on all blocks, and on all but each fold.
    pub(in crate::force) fn fit(&self, columns: &[usize]) -> Fitted {
        let mut columns = columns.to_vec();
        columns.retain(|&column| self.length[column] > 0.0);
        let folds = 0..self.parts.len();
        let without: Vec<Vec<f64>> = folds
            .into_par_iter()
            .map(|fold| self.solve(&columns, Some(fold)))
            .collect();
        let left = self.parts.iter().zip(&without).map(|(parts, numbers)| {
            let parts = parts.iter().zip(&self.weight);
            parts
                .map(|(part, weight)| weight * part.left(&columns, numbers))
                .collect()
        });
        Fitted {
            left: left.collect(),
            numbers: self.solve(&columns, None),
            without,
            columns,
        }
    }

    /// With another standard deviation of a number.
    pub(super) fn knowing(&mut self, column: usize, sd: f64) {
        self.sd[column] = sd;
    }

    /// Rows of each channel.
    pub(in crate::force) fn rows(&self, channel: usize) -> f64 {
        self.parts.iter().map(|parts| parts[channel].rows).sum()
    }
}

impl Fitted {
    /// The number of a column; 0 of one that it has not.
    pub(super) fn number(&self, column: usize) -> f64 {
        self.among(&self.numbers, column)
    }

    /// The numbers of a column without each fold.
    pub(super) fn each(&self, column: usize) -> impl Iterator<Item = f64> {
        self.without
            .iter()
            .map(move |numbers| self.among(numbers, column))
    }

    fn among(&self, numbers: &[f64], column: usize) -> f64 {
        let place = self.columns.iter().position(|&own| own == column);
        place.map_or(0.0, |place| numbers[place])
    }

    /// What it leaves of some channels, all folds.
    pub(in crate::force) fn left_on(&self, channels: &[usize]) -> f64 {
        let folds = self.left.iter();
        folds
            .map(|left| channels.iter().map(|&channel| left[channel]).sum::<f64>())
            .sum()
    }

    /// What `other` leaves more than this on some channels.
    pub(in crate::force) fn gain_over(&self, other: &Self, channels: &[usize]) -> Gain {
        let sum = |left: &Vec<f64>| channels.iter().map(|&channel| left[channel]).sum::<f64>();
        let pairs = self.left.iter().zip(&other.left);
        let gains: Vec<f64> = pairs.map(|(own, other)| sum(other) - sum(own)).collect();
        let count = gains.len().max(2) as f64;
        let mean = gains.iter().sum::<f64>() / count;
        let square: f64 = gains.iter().map(|gain| (gain - mean).powi(2)).sum();
        let error = (square / (count - 1.0) / count).sqrt();
        Gain {
            sum: mean * count,
            t: if error > 0.0 { mean / error } else { 0.0 },
            share: gains.iter().filter(|gain| **gain > 0.0).count() as f64 / count,
        }
    }
}

impl Normal {
    /// Squares that numbers of some columns leave.
    fn left(&self, columns: &[usize], numbers: &[f64]) -> f64 {
        let mut left = self.square;
        for (&column, number) in columns.iter().zip(numbers) {
            let own = self.gram.column(column);
            let others = columns.iter().zip(numbers);
            let product: f64 = others.map(|(&row, other)| own[row] * other).sum();
            left += number * (product - 2.0 * self.right[column]);
        }
        left.max(0.0)
    }
}

/// Fold of each block: those before a change and those after it are cut alike.
fn folds(pair: &Pair) -> Vec<usize> {
    let count = |is_after: bool| pair.is_after.iter().filter(|&&own| own == is_after).count();
    let counts = [count(false), count(true)];
    let mut seen = [0, 0];
    let fold = |&is_after: &bool| {
        let side = usize::from(is_after);
        let place = seen[side];
        seen[side] += 1;
        place * FOLDS / counts[side].max(1)
    };
    pair.is_after.iter().map(fold).collect()
}

fn normal(columns: &Columns, reading: &[f64], channel: usize, rows: &[usize]) -> Normal {
    let count = columns.all.len();
    let own: Vec<f64> = rows.iter().map(|&row| reading[row]).collect();
    // columns that touch the channel, side by side
    let touching: Vec<usize> = (0..count)
        .filter(|&index| columns.all[index][channel].is_some())
        .collect();
    let dense = DMatrix::from_fn(rows.len(), touching.len(), |row, place| {
        let column = columns.all[touching[place]][channel].as_ref();
        column.map_or(0.0, |column| column[rows[row]])
    });
    let product = dense.tr_mul(&dense);
    let along = dense.tr_mul(&DVector::from_row_slice(&own));
    let mut gram = DMatrix::zeros(count, count);
    let mut right = DVector::zeros(count);
    for (a, &row) in touching.iter().enumerate() {
        right[row] = along[a];
        for (b, &column) in touching.iter().enumerate() {
            gram[(row, column)] = product[(a, b)];
        }
    }
    Normal {
        gram,
        right,
        square: own.iter().map(|value| value * value).sum(),
        rows: rows.len() as f64,
    }
}
