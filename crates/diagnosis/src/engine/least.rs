//! Least squares on subsets of one set of columns, from their products.

use nalgebra::{DMatrix, DVector};

use crate::engine::system::dot;

/// Products of columns with each other and with a target.
#[derive(Debug)]
pub(crate) struct Columns {
    /// Of columns of length 1.
    normal: DMatrix<f64>,
    right: DVector<f64>,
    pub(crate) norms: Vec<f64>,
    square: f64,
    readings: usize,
}

/// Share of a column's square that must lie across others for it to be one of its own.
const INDEPENDENT: f64 = 1e-6;
/// Share of a column's square that keeps dependent ones solvable.
const RIDGE: f64 = 1e-11;

impl Columns {
    pub(crate) fn new(columns: &[&[f64]], target: &[f64]) -> Self {
        let norms: Vec<f64> = columns
            .iter()
            .map(|column| dot(column, column).sqrt().max(1e-300))
            .collect();
        let count = columns.len();
        Self {
            normal: DMatrix::from_fn(count, count, |a, b| {
                dot(columns[a], columns[b]) / (norms[a] * norms[b])
            }),
            right: DVector::from_fn(count, |index, _| dot(columns[index], target) / norms[index]),
            norms,
            square: dot(target, target),
            readings: target.len(),
        }
    }

    fn part(&self, chosen: &[usize]) -> (DMatrix<f64>, DVector<f64>) {
        let part = DMatrix::from_fn(chosen.len(), chosen.len(), |a, b| {
            self.normal[(chosen[a], chosen[b])] + if a == b { RIDGE } else { 0.0 }
        });
        let side = DVector::from_fn(chosen.len(), |a, _| self.right[chosen[a]]);
        (part, side)
    }

    /// Squared length of the target's part in the span of the chosen columns.
    pub(crate) fn explained(&self, chosen: &[usize]) -> f64 {
        if chosen.is_empty() {
            return 0.0;
        }
        let (part, side) = self.part(chosen);
        match part.cholesky() {
            Some(factor) => side.dot(&factor.solve(&side)),
            None => 0.0,
        }
    }

    /// Coefficients of the chosen columns and their covariance; what they leave counts as noise where it is
    /// more than noise.
    pub(crate) fn solution(&self, chosen: &[usize]) -> Option<(Vec<f64>, DMatrix<f64>)> {
        let (part, side) = self.part(chosen);
        let factor = part.cholesky()?;
        let solved = factor.solve(&side);
        let left = self.square - side.dot(&solved);
        let freedom = self.readings.saturating_sub(chosen.len()).max(1) as f64;
        let misfit = (left / freedom).max(1.0);
        let norm = |k: usize| self.norms[chosen[k]];
        let values = (0..chosen.len()).map(|k| solved[k] / norm(k)).collect();
        let mut covariance = factor.inverse() * misfit;
        for a in 0..chosen.len() {
            for b in 0..chosen.len() {
                covariance[(a, b)] /= norm(a) * norm(b);
            }
        }
        Some((values, covariance))
    }

    /// Covariance of the first columns' coefficients where the others are free, for noise of unit size;
    /// others that depend on those before them are left out.
    pub(crate) fn covariance_given(
        &self,
        first: &[usize],
        others: &[usize],
    ) -> Option<DMatrix<f64>> {
        let mut chosen = first.to_vec();
        for &other in others {
            let (part, _) = self.part(&chosen);
            let along = DVector::from_fn(chosen.len(), |k, _| self.normal[(chosen[k], other)]);
            let explained = along.dot(&part.cholesky()?.solve(&along));
            if 1.0 - explained > INDEPENDENT {
                chosen.push(other);
            }
        }
        let inverse = self.part(&chosen).0.cholesky()?.inverse();
        Some(DMatrix::from_fn(first.len(), first.len(), |a, b| {
            inverse[(a, b)] / (self.norms[first[a]] * self.norms[first[b]])
        }))
    }

    /// Of others the one that most of a column is made of: where the column is a sum of them, it stands in that one's place.
    pub(crate) fn largest_part(&self, column: usize, others: &[usize]) -> Option<usize> {
        let (part, _) = self.part(others);
        let along = DVector::from_fn(others.len(), |k, _| self.normal[(others[k], column)]);
        let shares = part.cholesky()?.solve(&along);
        (!others.is_empty()).then(|| others[shares.iamax()])
    }

    /// Standard deviation of each column's coefficient with all others free, for noise of unit size.
    pub(crate) fn deviations(&self, count: usize) -> Vec<f64> {
        let all: Vec<usize> = (0..count).collect();
        let (part, _) = self.part(&all);
        match part.try_inverse() {
            Some(inverse) => (0..count)
                .map(|k| inverse[(k, k)].max(0.0).sqrt() / self.norms[k])
                .collect(),
            None => vec![0.0; count],
        }
    }
}
