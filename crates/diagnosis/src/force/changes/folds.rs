//! Least squares on some columns of a comparison, judged on blocks that the fit did not see.
//!
//! Normal equations per fold and channel are formed once; every hypothesis is then a small system of them. A channel weighs
//! by what the fullest hypothesis leaves of it, so that torques which no hypothesis describes do not drown the others.

use haptical_judge::{Gain, closed_share};
use haptical_linalg::{Matrix, NormalEquations, NormalSolution, dot};
use haptical_motion::Unseen;

use super::columns::{Columns, Pair};
use crate::thresholds::payload::{FOLDS, RIDGE};

/// The rows of a comparison in folds of blocks that follow each other.
#[derive(Debug, Clone)]
pub(in crate::force) struct Folds {
    /// Normal equations per fold, per channel.
    parts: Vec<Vec<NormalEquations>>,
    /// All channels weighted together: without each fold, then all.
    sums: Vec<NormalEquations>,
    /// The standard deviation that each column's number is known to have.
    sd: Vec<f64>,
    /// One over the variance of a block's reading, per channel.
    weight: Vec<f64>,
    rows: Vec<usize>,
}

/// A sum of columns, `(column, factor)` each, with the standard deviation of its number. It covers one channel or
/// all.
pub(super) type Sum = (Vec<(usize, f64)>, f64, Option<usize>);

/// A hypothesis fitted: its numbers, and what it leaves of unseen blocks.
#[derive(Debug, Clone)]
pub(in crate::force) struct Fitted {
    /// Places of its columns.
    pub(in crate::force) columns: Vec<usize>,
    numbers: Vec<f64>,
    /// The same without each fold.
    pub(super) without: Vec<Vec<f64>>,
    /// Weighted squares left of each fold, channel by channel.
    left: Vec<Vec<f64>>,
}

impl Folds {
    /// `least`: variances that blocks have by noise alone, channel by channel.
    pub(in crate::force) fn new(columns: &Columns, pair: &Pair, least: &[f64]) -> Self {
        let rows = folds(pair);
        let count = columns.all.len();
        let normal = |(fold, channel): (usize, usize)| {
            let all = columns.all.iter().chain([&pair.reading]);
            let parts = all.map(|column| -> Option<Vec<f64>> {
                let entries = rows[fold].iter().map(|&row| column[(row, channel)]);
                // most columns of drives are zero in the other channels
                let is_here = entries.clone().any(|entry| entry != 0.0);
                is_here.then(|| entries.collect())
            });
            let parts: Vec<Option<Vec<f64>>> = parts.collect();
            NormalEquations::from_products(count, |a, b| match (&parts[a], &parts[b]) {
                (Some(a), Some(b)) => dot(a, b),
                _ => 0.0,
            })
        };
        let channels = least.len();
        let places = (0..FOLDS).flat_map(|fold| (0..channels).map(move |channel| (fold, channel)));
        let all = haptical_parallel::map(places.collect::<Vec<_>>(), normal);
        let mut folds = Self {
            parts: all.chunks(channels.max(1)).map(<[_]>::to_vec).collect(),
            sums: Vec::new(),
            sd: columns.sd.clone(),
            weight: vec![1.0; channels],
            rows: rows.iter().map(Vec::len).collect(),
        };
        folds.weigh(least);
        folds
    }

    /// Weights by what all columns together leave of each channel.
    fn weigh(&mut self, least: &[f64]) {
        let every: Vec<usize> = (0..self.sd.len()).collect();
        let mut numbers: Option<Vec<f64>> = None;
        for _ in 0..3 {
            for channel in 0..self.weight.len() {
                let left = |sums: &NormalEquations| match &numbers {
                    Some(numbers) => sums.left(&every, numbers),
                    None => sums.target_square(),
                };
                let square: f64 = self.parts.iter().map(|parts| left(&parts[channel])).sum();
                let mean = (square / self.count().max(1.0)).max(least[channel]);
                self.weight[channel] = 1.0 / mean.max(1e-300);
            }
            self.measure();
            numbers = Some(self.solve(&every, FOLDS).coefficients().to_vec());
        }
    }

    /// Sums over the weighted channels.
    fn measure(&mut self) {
        let count = self.sd.len();
        let mut sums = vec![NormalEquations::new(count); FOLDS + 1];
        for (fold, parts) in self.parts.iter().enumerate() {
            let mut weighted = NormalEquations::new(count);
            for (part, &weight) in parts.iter().zip(&self.weight) {
                weighted.add(part, weight);
            }
            let without = sums.iter_mut().enumerate();
            for (_, sum) in without.filter(|(other, _)| *other != fold) {
                sum.add(&weighted, 1.0);
            }
        }
        self.sums = sums;
    }

    /// Rows of each channel.
    fn count(&self) -> f64 {
        self.rows.iter().sum::<usize>() as f64
    }

    /// Counts what two hypotheses leave of a channel on blocks that they were not fitted to.
    pub(super) fn unseen(&self, channel: usize, [null, all]: [&Fitted; 2], unseen: &mut Unseen) {
        unseen.rows[..FOLDS].copy_from_slice(&self.rows);
        for fold in 0..FOLDS {
            let left = |fitted: &Fitted| fitted.left[fold][channel] / self.weight[channel];
            (unseen.before[fold], unseen.after[fold]) = (left(null), left(all));
        }
    }

    /// Square of a column on all blocks.
    fn square(&self, column: usize) -> f64 {
        self.sums[FOLDS].product(column, column)
    }

    /// Fits columns to all folds but one, or to all (`FOLDS`). What is known of a number beforehand counts. Where
    /// only sums of numbers show, the smallest solution is taken.
    fn solve(&self, columns: &[usize], without: usize) -> NormalSolution {
        let known = |column: usize| RIDGE * self.square(column) + self.sd[column].powi(-2);
        self.sums[without].solve(columns, known)
    }

    /// What a sum of a fit's numbers, `(column, factor)` each, is wrong by because what is known of its numbers beforehand is
    /// known to a deviation: of an estimate A^-1 X^T y with prior precisions P the part -A^-1 P theta, with theta as P says.
    pub(super) fn prior_sd(&self, fitted: &Fitted, sum: &[(usize, f64)]) -> f64 {
        let columns = &fitted.columns;
        let factor = |&column: &usize| {
            let factors = sum.iter().filter(|(other, _)| *other == column);
            factors.map(|(_, factor)| factor).sum()
        };
        let right: Vec<f64> = columns.iter().map(factor).collect();
        let moved = self.solve(columns, FOLDS).inverse_times(&right);
        let pairs = columns.iter().zip(&moved);
        let square = pairs.map(|(&column, moved)| (moved / self.sd[column]).powi(2));
        square.sum::<f64>().sqrt()
    }

    /// Fits a hypothesis on all blocks, and on all but each fold.
    pub(in crate::force) fn fit(&self, columns: &[usize]) -> Fitted {
        let mut columns = columns.to_vec();
        columns.retain(|&column| self.square(column) > 0.0);
        let numbers = |without| self.solve(&columns, without).coefficients().to_vec();
        let mut without = haptical_parallel::map(0..=FOLDS, numbers);
        let numbers = without.pop().unwrap_or_default();
        let left = self.parts.iter().zip(&without).map(|(parts, numbers)| {
            let parts = parts.iter().zip(&self.weight);
            let left = parts.map(|(part, weight)| weight * part.left(&columns, numbers));
            left.collect()
        });
        Fitted {
            left: left.collect(),
            numbers,
            without,
            columns,
        }
    }

    /// Adds sums of columns and returns their places.
    pub(super) fn add_sums(&mut self, sums: &[Sum]) -> Vec<usize> {
        let first = self.sd.len();
        for parts in &mut self.parts {
            for (channel, part) in parts.iter_mut().enumerate() {
                let terms = sums.iter().map(|(terms, _, only)| -> &[_] {
                    let is_here = only.is_none_or(|only| only == channel);
                    if is_here { terms } else { &[] }
                });
                *part = part.with_sums(&terms.collect::<Vec<_>>());
            }
        }
        self.sd.extend(sums.iter().map(|(_, sd, _)| sd));
        self.measure();
        (first..self.sd.len()).collect()
    }

    /// Normal equations of some columns over all blocks, less what `others` can take of them.
    pub(super) fn apart(&self, columns: &[usize], others: &[usize]) -> Matrix {
        self.sums[FOLDS].across(&self.solve(others, FOLDS), columns)
    }

    /// With another standard deviation of a number.
    pub(super) fn knowing(&mut self, column: usize, sd: f64) {
        self.sd[column] = sd;
    }

    /// Share of the squares beyond noise, over all channels, that the first hypothesis leaves and the second does
    /// not. `variance` is that of a block's reading by noise alone, per channel.
    pub(in crate::force) fn closed(&self, [null, all]: [&Fitted; 2], variance: &[f64]) -> f64 {
        let variances = self.weight.iter().zip(variance);
        let noise = variances.map(|(weight, variance)| weight * variance * self.count());
        let [before, after] = [null, all].map(|fitted| fitted.by_fold(|_| true));
        let closed = closed_share(&before, &after, noise.sum());
        closed.share.clamp(0.0, 1.0)
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
    fn by_fold(&self, is_wanted: impl Fn(usize) -> bool) -> Vec<f64> {
        let wanted = |left: &Vec<f64>| {
            let channels = left.iter().enumerate();
            let wanted = channels.filter(|(channel, _)| is_wanted(*channel));
            wanted.map(|(_, left)| left).sum()
        };
        self.left.iter().map(wanted).collect()
    }

    /// What it leaves of some channels, all folds.
    pub(super) fn left_on(&self, channels: &[usize]) -> f64 {
        let left = self.by_fold(|channel| channels.contains(&channel));
        left.iter().sum()
    }

    /// How much more `other` leaves than this, of all channels or of one.
    pub(in crate::force) fn gain_over(&self, other: &Self, of: Option<usize>) -> Gain {
        let [before, after] = [other, self]
            .map(|fitted| fitted.by_fold(|channel| of.is_none_or(|only| only == channel)));
        Gain::between(&before, &after)
    }
}

/// Blocks of each fold: those before a change and those after it are cut alike.
fn folds(pair: &Pair) -> Vec<Vec<usize>> {
    let mut folds = vec![Vec::new(); FOLDS];
    for side in [false, true] {
        let blocks = pair.is_after().enumerate();
        let blocks = blocks.filter(|(_, is_after)| *is_after == side);
        let blocks: Vec<usize> = blocks.map(|(block, _)| block).collect();
        for (place, block) in blocks.iter().enumerate() {
            folds[place * FOLDS / blocks.len()].push(*block);
        }
    }
    folds
}
