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
    /// Rows that are not held out.
    seen: Vec<Range<usize>>,
}

impl<'c> Columns<'c> {
    /// On rows of which a part is held out.
    pub(crate) fn new(
        columns: Vec<Option<&'c [f64]>>,
        scored: &[Range<usize>],
        held: &Held,
    ) -> Self {
        let seen = match held {
            None => scored.to_vec(),
            Some(held) => scored
                .iter()
                .flat_map(|own| {
                    let before = own.start..own.end.min(held.start);
                    [before, own.start.max(held.end)..own.end]
                })
                .filter(|own| !own.is_empty())
                .collect(),
        };
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
        let rows = self.seen.iter().cloned().flatten();
        let count: usize = self.seen.iter().map(ExactSizeIterator::len).sum();
        rows.map(values).sum::<f64>() / count.max(1) as f64
    }
}

/// Row by row in their order, so that it is the same with nothing held out as with an empty range.
fn product(seen: &[Range<usize>], a: &[f64], b: &[f64]) -> f64 {
    let pairs = seen
        .iter()
        .flat_map(|own| a[own.clone()].iter().zip(&b[own.clone()]));
    pairs.map(|(a, b)| a * b).sum()
}
