//! Least squares on columns that are taken up one after the other, with their coefficients.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::engine::layout::Layout;
use crate::engine::system::System;
use crate::thresholds::engine::AGAIN_BELOW;

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

    /// Number of columns.
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

    /// Takes a column up.
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
