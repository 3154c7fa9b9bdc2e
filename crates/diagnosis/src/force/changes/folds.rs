//! Least squares on some columns of a comparison, judged on blocks that the fit did not see.
//!
//! Normal equations per fold and channel are formed once; every hypothesis is then a small system of them. A channel weighs
//! by what the fullest hypothesis leaves of it, so that torques which no hypothesis describes do not drown the others.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::blocks::Pair;
use super::columns::Columns;
use super::gain::Gain;
use super::normal::Normal;
use crate::thresholds::payload::{FOLDS, RIDGE};

/// The rows of a comparison in folds of blocks that follow each other.
#[derive(Debug, Clone)]
pub(in crate::force) struct Folds {
    /// Per fold, per channel.
    parts: Vec<Vec<Normal>>,
    /// Per fold, all channels weighted together: matrix and right side.
    sums: Vec<(DMatrix<f64>, DVector<f64>)>,
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
            Normal::new(columns, &pair.reading[channel], channel, &rows)
        };
        let all: Vec<Normal> = haptical_parallel::map(&places, normal);
        let parts: Vec<Vec<Normal>> = all
            .chunks(channels.max(1))
            .map(<[Normal]>::to_vec)
            .collect();
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

    /// Sums over the weighted channels, and the columns' lengths by them.
    fn measure(&mut self) {
        let count = self.sd.len();
        let sum = |parts: &Vec<Normal>| {
            let (mut gram, mut right) = (DMatrix::zeros(count, count), DVector::zeros(count));
            for (part, &weight) in parts.iter().zip(&self.weight) {
                let entries = gram.iter_mut().zip(part.gram.iter());
                entries.for_each(|(sum, entry)| *sum += weight * entry);
                right.axpy(weight, &part.right, 1.0);
            }
            (gram, right)
        };
        self.sums = self.parts.iter().map(sum).collect();
        let square = |column: usize| {
            let folds = self.sums.iter();
            folds.map(|(gram, _)| gram[(column, column)]).sum::<f64>()
        };
        self.length = (0..count).map(|column| square(column).sqrt()).collect();
    }

    /// Numbers of the columns, one fold left out.
    fn solve(&self, columns: &[usize], without: Option<usize>) -> Vec<f64> {
        let mut right = DVector::<f64>::zeros(columns.len());
        for (_, own) in self.kept(without) {
            for (sum, &column) in right.iter_mut().zip(columns) {
                *sum += own[column];
            }
        }
        self.divided(columns, right, without)
    }

    /// Sums of all folds but one.
    fn kept(&self, without: Option<usize>) -> impl Iterator<Item = &(DMatrix<f64>, DVector<f64>)> {
        let folds = self.sums.iter().enumerate();
        let kept = folds.filter(move |(fold, _)| Some(*fold) != without);
        kept.map(|(_, sums)| sums)
    }

    /// A right side divided by the normal matrix of some columns, one fold left out.
    fn divided(
        &self,
        columns: &[usize],
        mut right: DVector<f64>,
        without: Option<usize>,
    ) -> Vec<f64> {
        let count = columns.len();
        let mut gram = DMatrix::<f64>::zeros(count, count);
        for (own, _) in self.kept(without) {
            for (b, &column) in columns.iter().enumerate() {
                for (a, &row) in columns.iter().enumerate().skip(b) {
                    gram[(a, b)] += own[(row, column)];
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

    /// What a sum of a fit's numbers, `(column, factor)` each, is wrong by because what is known of its numbers beforehand is
    /// known to a deviation: of an estimate A^-1 X^T y with prior precisions P the part -A^-1 P theta, with theta as P says.
    pub(super) fn prior_sd(&self, fitted: &Fitted, sum: &[(usize, f64)]) -> f64 {
        let columns = &fitted.columns;
        let mut right = DVector::<f64>::zeros(columns.len());
        for (place, column) in columns.iter().enumerate() {
            let own = sum.iter().filter(|(other, _)| other == column);
            right[place] = own.map(|(_, factor)| factor).sum();
        }
        let moved = self.divided(columns, right, None);
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

    /// Adds the sum of some columns, channel by channel, with what each of these factors is known to; their places.
    pub(super) fn scale(&mut self, columns: &[usize], numbers: &[f64], sds: &[f64]) -> Vec<usize> {
        let first = self.sd.len();
        for part in self
            .parts
            .iter_mut()
            .flat_map(|parts| parts.iter_mut().enumerate())
        {
            let (channel, part) = part;
            part.add_sum(columns, numbers, first + channel, first + sds.len());
        }
        self.sd.extend(sds);
        self.measure();
        (first..self.sd.len()).collect()
    }

    /// Adds sums of columns, `(column, factor)` each, over all channels, of whose factors nothing is known; their places.
    pub(super) fn add_sums(&mut self, sums: &[Vec<(usize, f64)>]) -> Vec<usize> {
        let first = self.sd.len();
        for (place, sum) in sums.iter().enumerate() {
            let (columns, numbers): (Vec<usize>, Vec<f64>) = sum.iter().copied().unzip();
            for part in self.parts.iter_mut().flatten() {
                part.add_sum(&columns, &numbers, first + place, first + place + 1);
            }
        }
        self.sd.extend(sums.iter().map(|_| f64::INFINITY));
        self.measure();
        (first..self.sd.len()).collect()
    }

    /// Normal equations of some columns over all blocks, less what `beside` can take of them.
    pub(super) fn apart(&self, columns: &[usize], beside: &[usize]) -> DMatrix<f64> {
        let sum = |a: &[usize], b: &[usize]| {
            DMatrix::from_fn(a.len(), b.len(), |row, column| {
                let folds = self.kept(None);
                folds.map(|(gram, _)| gram[(a[row], b[column])]).sum()
            })
        };
        let mut known = sum(beside, beside);
        for (place, &column) in beside.iter().enumerate() {
            known[(place, place)] += RIDGE * self.length[column].powi(2) + self.sd[column].powi(-2);
        }
        let across = sum(beside, columns);
        let all = sum(columns, columns);
        match Cholesky::new(known) {
            Some(factor) => all - across.tr_mul(&factor.solve(&across)),
            None => all,
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

    /// The same without a fold.
    pub(super) fn nth(&self, fold: usize, column: usize) -> f64 {
        self.among(&self.without[fold], column)
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
        Gain::new(&gains)
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
