//! Least squares of a few columns, all fixed but one.

use std::ops::Range;

use haptical_linalg::{Matrix, NormalEquations};

use super::Held;
use crate::thresholds::RIDGE;

/// Columns of a model and their products on the rows that are not held out.
#[derive(Debug)]
pub(crate) struct Columns<'c> {
    /// In the order of the solution; `None` is the one that is not fixed.
    columns: Vec<Option<&'c [f64]>>,
    products: Matrix,
    /// Rows before and after those that are held out.
    seen: [Range<usize>; 2],
}

impl<'c> Columns<'c> {
    /// Of so many rows each.
    pub(crate) fn new(columns: Vec<Option<&'c [f64]>>, rows: usize, held: &Held) -> Self {
        let held = held.clone().unwrap_or(rows..rows);
        let seen = [0..held.start.min(rows), held.end.min(rows)..rows];
        let products = Matrix::from_fn(columns.len(), columns.len(), |i, j| {
            match (columns[i], columns[j]) {
                (Some(a), Some(b)) if j <= i => product(&seen, a, b),
                _ => 0.0,
            }
        });
        Self {
            columns,
            products,
            seen,
        }
    }

    /// Coefficients on the rows that are not held out, and the residual on all rows.
    pub(crate) fn solve(&self, free: &[f64], target: Vec<f64>) -> (Vec<f64>, Vec<f64>) {
        let count = self.columns.len();
        if count == 0 {
            return (Vec::new(), target);
        }
        let column = |place: usize| match place == count {
            true => target.as_slice(),
            false => self.columns[place].unwrap_or(free),
        };
        let is_known = |place: usize| place < count && self.columns[place].is_some();
        let sums = NormalEquations::from_products(count, |a, b| match is_known(a) && is_known(b) {
            true => self.products[(a, b)],
            false => product(&self.seen, column(a), column(b)),
        });
        let all: Vec<usize> = (0..count).collect();
        let fit = sums.solve(&all, |place| RIDGE * sums.product(place, place));
        let solution = fit.coefficients().to_vec();
        let mut residual = vec![0.0; target.len()];
        for (place, coefficient) in solution.iter().enumerate() {
            for (sum, value) in residual.iter_mut().zip(column(place)) {
                *sum += value * coefficient;
            }
        }
        for (own, target) in residual.iter_mut().zip(&target) {
            *own = target - *own;
        }
        (solution, residual)
    }

    /// Sum over the rows that are not held out.
    pub(crate) fn squares(&self, residual: &[f64]) -> f64 {
        product(&self.seen, residual, residual)
    }

    /// Mean over the rows that are not held out.
    pub(crate) fn mean(&self, values: impl Fn(usize) -> f64) -> f64 {
        let [before, after] = self.seen.clone();
        let count = (before.len() + after.len()).max(1);
        before.chain(after).map(values).sum::<f64>() / count as f64
    }
}

/// Row by row in their order, so that it is the same with nothing held out as with an empty range.
fn product(seen: &[Range<usize>; 2], a: &[f64], b: &[f64]) -> f64 {
    let [before, after] = seen.clone();
    let before = a[before.clone()].iter().zip(&b[before]);
    let after = a[after.clone()].iter().zip(&b[after]);
    before.chain(after).map(|(a, b)| a * b).sum()
}
