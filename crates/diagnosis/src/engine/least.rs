//! Least squares on subsets of one set of columns, from their products.

use haptical_linalg::{Matrix, NormalEquations, NormalSolution};
use nalgebra::DMatrix;

use crate::thresholds::engine::{INDEPENDENT, LEAST_SQUARES_RIDGE};

/// Products of columns with each other and with a target.
#[derive(Debug)]
pub(crate) struct Columns {
    sums: NormalEquations,
    pub(crate) norms: Vec<f64>,
    readings: usize,
}

impl Columns {
    pub(crate) fn new(columns: &[&[f64]], target: &[f64]) -> Self {
        let sums = NormalEquations::from_columns(columns, target);
        let norm = |column: usize| sums.product(column, column).sqrt().max(1e-300);
        Self {
            norms: (0..columns.len()).map(norm).collect(),
            sums,
            readings: target.len(),
        }
    }

    fn fit(&self, chosen: &[usize]) -> NormalSolution {
        let ridge = |column: usize| LEAST_SQUARES_RIDGE * self.norms[column].powi(2);
        self.sums.solve(chosen, ridge)
    }

    /// Squared length of the target's part in the span of the chosen columns.
    pub(crate) fn explained(&self, chosen: &[usize]) -> f64 {
        self.fit(chosen).explained()
    }

    /// Coefficients of the chosen columns and their covariance; what they leave counts as noise where it is
    /// more than noise.
    pub(crate) fn solution(&self, chosen: &[usize]) -> (Vec<f64>, DMatrix<f64>) {
        let fit = self.fit(chosen);
        let freedom = self.readings.saturating_sub(chosen.len()).max(1) as f64;
        let misfit = (fit.rest_square() / freedom).max(1.0);
        let covariance = first(&fit.inverse(), chosen.len()) * misfit;
        (fit.coefficients().to_vec(), covariance)
    }

    /// Covariance of the first columns' coefficients where the others are free, for noise of unit size;
    /// others that depend on those before them are left out.
    pub(crate) fn covariance_given(
        &self,
        first_columns: &[usize],
        others: &[usize],
    ) -> DMatrix<f64> {
        let mut chosen = first_columns.to_vec();
        for &other in others {
            let left = self.sums.across(&self.fit(&chosen), &[other])[(0, 0)];
            if left > INDEPENDENT * self.norms[other].powi(2) {
                chosen.push(other);
            }
        }
        first(&self.fit(&chosen).inverse(), first_columns.len())
    }

    /// Of others the one that most of a column is made of: where the column is a sum of them, it stands in that one's place.
    pub(crate) fn largest_part(&self, column: usize, others: &[usize]) -> Option<usize> {
        let along: Vec<f64> = (others.iter())
            .map(|&other| self.sums.product(other, column))
            .collect();
        let shares = self.fit(others).inverse_times(&along);
        let size = |place: &usize| (shares[*place] * self.norms[others[*place]]).abs();
        let places = (0..others.len()).max_by(|a, b| size(a).total_cmp(&size(b)));
        places.map(|place| others[place])
    }

    /// Standard deviation of each column's coefficient with all others free, for noise of unit size.
    pub(crate) fn deviations(&self, count: usize) -> Vec<f64> {
        let all: Vec<usize> = (0..count).collect();
        let inverse = self.fit(&all).inverse();
        (0..count)
            .map(|k| inverse[(k, k)].max(0.0).sqrt())
            .collect()
    }
}

/// The first rows and columns of a matrix.
fn first(matrix: &Matrix, count: usize) -> DMatrix<f64> {
    DMatrix::from_fn(count, count, |a, b| matrix[(a, b)])
}
