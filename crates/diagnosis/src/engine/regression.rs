//! Least squares with coefficients: on columns that are taken up one after the other, and on subsets of one set of columns.

use std::ops::Range;

use haptical_linalg::{Matrix, NormalEquations, NormalSolution};
use nalgebra::{DMatrix, DVector};

use crate::engine::{Layout, System};
use crate::thresholds::engine::{AGAIN_BELOW, INDEPENDENT, LEAST_SQUARES_RIDGE};

/// Columns, and the system that they leave.
#[derive(Debug, Clone)]
pub(crate) struct Regression<L> {
    pub(crate) system: System<L>,
    /// Whitened readings.
    reading: Vec<f64>,
    columns: Vec<Vec<f64>>,
    /// Columns that depend on none before them: those of the system's basis.
    independent: Vec<usize>,
    /// Products of each independent column with the basis, up to its own direction.
    triangle: Vec<Vec<f64>>,
}

impl<L: Layout> Regression<L> {
    /// Readings without columns, with the windows of each stream.
    pub(crate) fn new(layout: L, windows: Vec<Vec<Range<usize>>>, reading: Vec<f64>) -> Self {
        Self {
            system: System::bare(layout, windows, reading.clone()),
            reading,
            columns: Vec::new(),
            independent: Vec::new(),
            triangle: Vec::new(),
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.columns.len()
    }

    /// Whitened readings.
    pub(crate) fn reading(&self) -> &[f64] {
        &self.reading
    }

    /// A column over all entries.
    pub(crate) fn column(&self, index: usize) -> &[f64] {
        &self.columns[index]
    }

    pub(crate) fn add(&mut self, column: Vec<f64>) {
        let products = self.system.take_again_below(AGAIN_BELOW, column.clone());
        if let Some(products) = products {
            self.independent.push(self.columns.len());
            self.triangle.push(products);
        }
        self.columns.push(column);
    }

    /// Gives columns from `count` on back.
    pub(crate) fn truncate(&mut self, count: usize) -> Vec<Vec<f64>> {
        self.independent.retain(|&index| index < count);
        self.system.basis.truncate(self.independent.len());
        self.triangle.truncate(self.independent.len());
        self.system.project_reading(self.reading.clone());
        self.columns.split_off(count)
    }

    /// Entries behind all others: `reading` of them, with no part of the columns so far.
    pub(crate) fn append(&mut self, reading: &[f64]) {
        let count = self.reading.len() + reading.len();
        self.reading.extend_from_slice(reading);
        self.system.residual.extend_from_slice(reading);
        // directions are zero behind what they hold
        for column in &mut self.columns {
            column.resize(count, 0.0);
        }
    }

    /// Products of the basis with the independent columns.
    fn triangle(&self) -> DMatrix<f64> {
        let count = self.independent.len();
        DMatrix::from_fn(count, count, |row, column| {
            self.triangle[column].get(row).copied().unwrap_or(0.0)
        })
    }

    /// Coefficients of all columns; 0 of those that depend on others before them.
    pub(crate) fn solution(&self) -> Vec<f64> {
        let basis = self.system.basis.iter();
        let right = basis.map(|direction| direction.dot(&self.reading));
        let right = DVector::from_iterator(self.independent.len(), right);
        let mut solution = vec![0.0; self.len()];
        if let Some(values) = self.triangle().solve_upper_triangular(&right) {
            for (&index, &value) in self.independent.iter().zip(values.iter()) {
                solution[index] = value;
            }
        }
        solution
    }

    /// Covariance of the coefficients for noise of unit size; 0 for those that depend on others before them.
    pub(crate) fn covariance(&self) -> DMatrix<f64> {
        let count = self.independent.len();
        let unit = DMatrix::identity(count, count);
        let mut covariance = DMatrix::zeros(self.len(), self.len());
        if let Some(inverse) = self.triangle().solve_upper_triangular(&unit) {
            let own = &inverse * inverse.transpose();
            for (a, &row) in self.independent.iter().enumerate() {
                for (b, &column) in self.independent.iter().enumerate() {
                    covariance[(row, column)] = own[(a, b)];
                }
            }
        }
        covariance
    }
}

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

    /// Coefficients of the chosen columns and their covariance; what they leave counts as noise where it is more than noise, and so does
    /// what `others` may differ by, were they free.
    pub(crate) fn solution(&self, chosen: &[usize], others: &[usize]) -> (Vec<f64>, DMatrix<f64>) {
        let fit = self.fit(chosen);
        let freedom = self.readings.saturating_sub(chosen.len()).max(1) as f64;
        let misfit = (fit.rest_square() / freedom).max(1.0);
        let covariance = first(&fit.inverse(), chosen.len()) * misfit;
        let covariance = covariance + self.covariance_given(chosen, others);
        (fit.coefficients().to_vec(), covariance)
    }

    /// Covariance of the first columns' coefficients where the others are free, for noise of unit size;
    /// others that depend on those before them are left out.
    fn covariance_given(&self, first_columns: &[usize], others: &[usize]) -> DMatrix<f64> {
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
