//! Least squares on some columns of a comparison, judged on blocks that the fit did not see.
//!
//! Normal equations per fold and channel are formed once; every hypothesis is then a small system of them. A channel weighs
//! by what the fullest hypothesis leaves of it, so that torques which no hypothesis describes do not drown the others.

use haptical_judge::{Gain, closed_share};
use haptical_linalg::NormalEquations;
use nalgebra::DMatrix;

use super::blocks::Pair;
use super::columns::Columns;
use crate::thresholds::payload::{FOLDS, RIDGE};

/// The rows of a comparison in folds of blocks that follow each other.
#[derive(Debug, Clone)]
pub(in crate::force) struct Folds {
    /// Per fold, per channel: products, and number of rows.
    parts: Vec<Vec<(NormalEquations, f64)>>,
    /// All channels weighted together: without each fold, then all.
    sums: Vec<NormalEquations>,
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
            let sums = products(columns, &pair.reading[channel], channel, &rows);
            (sums, rows.len() as f64)
        };
        let all: Vec<(NormalEquations, f64)> = haptical_parallel::map(&places, normal);
        let parts = all.chunks(channels.max(1)).map(<[_]>::to_vec).collect();
        let mut folds = Self {
            parts,
            sums: Vec::new(),
            length: Vec::new(),
            sd: columns.sd.clone(),
            weight: vec![1.0; channels],
        };
        folds.weigh(least);
        folds
    }

    /// Weights by what all columns together leave of each channel.
    fn weigh(&mut self, least: &[f64]) {
        let mean = |folds: &Self, channel: usize, left: &dyn Fn(&NormalEquations) -> f64| {
            let parts = folds.parts.iter().map(|parts| &parts[channel]);
            let square: f64 = parts.clone().map(|(sums, _)| left(sums)).sum();
            (square / folds.rows(channel).max(1.0))
                .max(least[channel])
                .max(1e-300)
        };
        for channel in 0..self.weight.len() {
            self.weight[channel] = 1.0 / mean(self, channel, &NormalEquations::target_square);
        }
        let every: Vec<usize> = (0..self.sd.len()).collect();
        for _ in 0..2 {
            self.measure();
            let numbers = self.solve(&every, None);
            for channel in 0..self.weight.len() {
                let left = |sums: &NormalEquations| sums.left(&every, &numbers);
                self.weight[channel] = 1.0 / mean(self, channel, &left);
            }
        }
        self.measure();
    }

    /// Sums over the weighted channels, and the columns' lengths by them.
    fn measure(&mut self) {
        let count = self.sd.len();
        let mut sums = vec![NormalEquations::new(count); self.parts.len() + 1];
        for (fold, parts) in self.parts.iter().enumerate() {
            let mut own = NormalEquations::new(count);
            for ((part, _), &weight) in parts.iter().zip(&self.weight) {
                own.add(part, weight);
            }
            let without = sums.iter_mut().enumerate();
            for (_, sum) in without.filter(|(other, _)| *other != fold) {
                sum.add(&own, 1.0);
            }
        }
        self.sums = sums;
        let all = self.without(None);
        self.length = (0..count)
            .map(|column| all.product(column, column).sqrt())
            .collect();
    }

    /// Sums of all folds but one.
    fn without(&self, fold: Option<usize>) -> &NormalEquations {
        &self.sums[fold.unwrap_or(self.parts.len())]
    }

    /// What is known of a number beforehand, and of those that only sums of which show a smallest solution.
    fn known(&self, column: usize) -> f64 {
        RIDGE * self.length[column].powi(2) + self.sd[column].powi(-2)
    }

    /// Numbers of the columns, one fold left out.
    fn solve(&self, columns: &[usize], without: Option<usize>) -> Vec<f64> {
        let fit = self
            .without(without)
            .solve(columns, |column| self.known(column));
        fit.coefficients().to_vec()
    }

    /// What a sum of a fit's numbers, `(column, factor)` each, is wrong by because what is known of its numbers beforehand is
    /// known to a deviation: of an estimate A^-1 X^T y with prior precisions P the part -A^-1 P theta, with theta as P says.
    pub(super) fn prior_sd(&self, fitted: &Fitted, sum: &[(usize, f64)]) -> f64 {
        let columns = &fitted.columns;
        let factor = |&column: &usize| {
            let own = sum.iter().filter(|(other, _)| *other == column);
            own.map(|(_, factor)| factor).sum()
        };
        let right: Vec<f64> = columns.iter().map(factor).collect();
        let fit = self
            .without(None)
            .solve(columns, |column| self.known(column));
        let moved = fit.inverse_times(&right);
        let pairs = columns.iter().zip(&moved);
        let square = pairs.map(|(&column, moved)| (moved / self.sd[column]).powi(2));
        square.sum::<f64>().sqrt()
    }

    /// Fits a hypothesis on all blocks, and on all but each fold.
    pub(in crate::force) fn fit(&self, columns: &[usize]) -> Fitted {
        let mut columns = columns.to_vec();
        columns.retain(|&column| self.length[column] > 0.0);
        let folds = 0..self.parts.len();
        let without: Vec<Vec<f64>> =
            haptical_parallel::map(folds, |fold| self.solve(&columns, Some(fold)));
        let left = self.parts.iter().zip(&without).map(|(parts, numbers)| {
            let parts = parts.iter().zip(&self.weight);
            parts
                .map(|((part, _), weight)| weight * part.left(&columns, numbers))
                .collect()
        });
        Fitted {
            left: left.collect(),
            numbers: self.solve(&columns, None),
            without,
            columns,
        }
    }

    /// Adds the sum of some columns, channel by channel, with what each of these factors is known to; their places.
    pub(super) fn scale(&mut self, columns: &[usize], numbers: &[f64], sds: &[f64]) -> Vec<usize> {
        let first = self.sd.len();
        let terms: Vec<(usize, f64)> = columns
            .iter()
            .copied()
            .zip(numbers.iter().copied())
            .collect();
        for (channel, (part, _)) in self
            .parts
            .iter_mut()
            .flat_map(|parts| parts.iter_mut().enumerate())
        {
            for place in 0..sds.len() {
                let own = if place == channel {
                    terms.as_slice()
                } else {
                    &[]
                };
                *part = part.with_sum(own);
            }
        }
        self.sd.extend(sds);
        self.measure();
        (first..self.sd.len()).collect()
    }

    /// Adds sums of columns, `(column, factor)` each, over all channels, of whose factors nothing is known; their places.
    pub(super) fn add_sums(&mut self, sums: &[Vec<(usize, f64)>]) -> Vec<usize> {
        let first = self.sd.len();
        for (part, _) in self.parts.iter_mut().flatten() {
            for sum in sums {
                *part = part.with_sum(sum);
            }
        }
        self.sd.extend(sums.iter().map(|_| f64::INFINITY));
        self.measure();
        (first..self.sd.len()).collect()
    }

    /// Normal equations of some columns over all blocks, less what `beside` can take of them.
    pub(super) fn apart(&self, columns: &[usize], beside: &[usize]) -> DMatrix<f64> {
        let all = self.without(None);
        let left = all.across(&all.solve(beside, |column| self.known(column)), columns);
        DMatrix::from_fn(columns.len(), columns.len(), |a, b| left[(a, b)])
    }

    /// With another standard deviation of a number.
    pub(super) fn knowing(&mut self, column: usize, sd: f64) {
        self.sd[column] = sd;
    }

    /// Weighted squares of some channels by noise alone; `variance`: of a block's reading, per channel.
    pub(in crate::force) fn noise(&self, channels: &[usize], variance: &[f64]) -> f64 {
        let of = |&channel: &usize| self.weight[channel] * variance[channel] * self.rows(channel);
        channels.iter().map(of).sum()
    }

    /// Rows of each channel.
    pub(in crate::force) fn rows(&self, channel: usize) -> f64 {
        self.parts.iter().map(|parts| parts[channel].1).sum()
    }
}

impl Fitted {
    /// The number of a column; 0 of one that it has not.
    pub(super) fn number(&self, column: usize) -> f64 {
        self.among(&self.numbers, column)
    }

    /// The same without a fold.
    pub(super) fn nth(&self, fold: usize, column: usize) -> f64 {
        self.among(&self.without[fold], column)
    }

    fn among(&self, numbers: &[f64], column: usize) -> f64 {
        let place = self.columns.iter().position(|&own| own == column);
        place.map_or(0.0, |place| numbers[place])
    }

    /// What it leaves of some channels, fold by fold.
    pub(in crate::force) fn by_fold(&self, channels: &[usize]) -> Vec<f64> {
        let of = |left: &Vec<f64>| channels.iter().map(|&channel| left[channel]).sum();
        self.left.iter().map(of).collect()
    }

    /// What it leaves of some channels, all folds.
    pub(in crate::force) fn left_on(&self, channels: &[usize]) -> f64 {
        self.by_fold(channels).iter().sum()
    }

    /// Share of the squares beyond noise that `other` leaves of some channels and this does not.
    pub(in crate::force) fn closed_of(&self, other: &Self, channels: &[usize], noise: f64) -> f64 {
        let (before, after) = (other.by_fold(channels), self.by_fold(channels));
        closed_share(&before, &after, noise).share.clamp(0.0, 1.0)
    }

    /// What `other` leaves more than this on some channels.
    pub(in crate::force) fn gain_over(&self, other: &Self, channels: &[usize]) -> Gain {
        Gain::between(&other.by_fold(channels), &self.by_fold(channels))
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

/// Products of the rows of one fold and channel.
fn products(columns: &Columns, reading: &[f64], channel: usize, rows: &[usize]) -> NormalEquations {
    let count = columns.all.len();
    // columns that touch the channel, side by side, and the reading behind them
    let touching: Vec<usize> = (0..count)
        .filter(|&index| columns.all[index][channel].is_some())
        .collect();
    let dense = DMatrix::from_fn(rows.len(), touching.len() + 1, |row, place| {
        let column = touching
            .get(place)
            .and_then(|&index| columns.all[index][channel].as_ref());
        column.map_or(reading[rows[row]], |column| column[rows[row]])
    });
    let products = dense.tr_mul(&dense);
    let mut place = vec![None; count + 1];
    place[count] = Some(touching.len());
    for (at, &index) in touching.iter().enumerate() {
        place[index] = Some(at);
    }
    NormalEquations::from_products(count, |a, b| match (place[a], place[b]) {
        (Some(a), Some(b)) => products[(a, b)],
        _ => 0.0,
    })
}
