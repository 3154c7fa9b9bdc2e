//! Generalised least squares in information form: base columns with priors, and what a further
//! group of columns would explain (a score test) without building a projection.
//!
//! docs/diagnosis-force.md, "Score test", derives the formulas.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::columns::{Fast, FastTable, Term, Values};
use super::weights::Weights;
use crate::engine::system::dot;

/// Part of a scaled column's square that is added for it to be decomposed in any case: directions
/// weaker than its root are left where they are.
const RIDGE: f64 = 1e-9;

/// A base column.
#[derive(Debug, Clone)]
pub(super) struct Known {
    pub(super) values: Vec<f64>,
    pub(super) weighed: Vec<f64>,
    /// One over the variance of its prior about zero; 0 for none.
    pub(super) prior: f64,
    /// Base column whose prior a release lifts.
    pub(super) releases: Option<usize>,
    pub(super) fast: Option<Fast>,
}

/// Base columns, their normal equations and solution.
#[derive(Debug)]
pub(super) struct Normal<'w> {
    pub(super) weights: &'w Weights,
    pub(super) fast: FastTable,
    pub(super) weighed_reading: Vec<f64>,
    pub(super) known: Vec<Known>,
    gram: DMatrix<f64>,
    right: DVector<f64>,
    scale: DVector<f64>,
    factor: Option<Cholesky<f64, Dyn>>,
    pub(super) solution: DVector<f64>,
}

impl<'w> Normal<'w> {
    /// Base columns (channel after channel) with priors, against a reading.
    pub(super) fn new(
        weights: &'w Weights,
        reading: &[f64],
        columns: Vec<(Vec<f64>, f64)>,
    ) -> Self {
        let known: Vec<Known> = columns
            .into_iter()
            .map(|(values, prior)| Known {
                weighed: weights.weigh(&values),
                values,
                prior,
                releases: None,
                fast: None,
            })
            .collect();
        let rows = reading.len();
        let mut all = Vec::with_capacity(rows * known.len());
        let mut weighed = Vec::with_capacity(rows * known.len());
        for column in &known {
            all.extend_from_slice(&column.values);
            weighed.extend_from_slice(&column.weighed);
        }
        let all = DMatrix::from_vec(rows, known.len(), all).transpose();
        let mut gram = all * DMatrix::from_vec(rows, known.len(), weighed);
        for (index, column) in known.iter().enumerate() {
            gram[(index, index)] += column.prior;
        }
        let weighed_reading = weights.weigh(reading);
        let right = DVector::from_iterator(
            known.len(),
            known
                .iter()
                .map(|column| dot(&column.values, &weighed_reading)),
        );
        let mut normal = Self {
            weights,
            fast: FastTable::default(),
            weighed_reading,
            known,
            gram,
            right,
            scale: DVector::zeros(0),
            factor: None,
            solution: DVector::zeros(0),
        };
        normal.solve();
        normal
    }

    pub(super) fn columns(&self) -> usize {
        self.known.len()
    }

    /// Replaces base columns whose shape depends on the solution.
    pub(super) fn replace(&mut self, first: usize, columns: Vec<Vec<f64>>) {
        for (offset, values) in columns.into_iter().enumerate() {
            let index = first + offset;
            self.known[index].weighed = self.weights.weigh(&values);
            self.known[index].values = values;
            self.right[index] = dot(&self.known[index].values, &self.weighed_reading);
            for other in 0..self.known.len() {
                let product = dot(&self.known[other].values, &self.known[index].weighed);
                self.gram[(index, other)] = product;
                self.gram[(other, index)] = product;
            }
            self.gram[(index, index)] += self.known[index].prior;
        }
        self.solve();
    }

    fn solve(&mut self) {
        let count = self.known.len();
        self.scale = DVector::from_iterator(
            count,
            (0..count).map(|k| {
                let square = self.gram[(k, k)];
                if square > 0.0 {
                    1.0 / square.sqrt()
                } else {
                    0.0
                }
            }),
        );
        self.factor = Cholesky::new(self.scaled(self.gram.clone()));
        self.solution = self.inverse_times(&self.right);
    }

    /// The inverse of the normal matrix times a vector.
    pub(super) fn inverse_times(&self, vector: &DVector<f64>) -> DVector<f64> {
        let Some(factor) = &self.factor else {
            return DVector::zeros(vector.len());
        };
        let scaled = vector.component_mul(&self.scale);
        factor.solve(&scaled).component_mul(&self.scale)
    }

    /// The base columns' part of the reading.
    pub(super) fn fitted(&self) -> Vec<f64> {
        let mut fitted = vec![0.0; self.weighed_reading.len()];
        for (column, &value) in self.known.iter().zip(self.solution.iter()) {
            if value != 0.0 {
                for (sum, entry) in fitted.iter_mut().zip(&column.values) {
                    *sum += value * entry;
                }
            }
        }
        fitted
    }

    /// The base columns' normal matrix and right side, scaled, with some columns known beforehand,
    /// `(column, value, deviation)`; the scale of the solution.
    pub(super) fn with_knowledge(
        &self,
        known: &[&(usize, f64, f64)],
    ) -> (DMatrix<f64>, DVector<f64>, &DVector<f64>) {
        let mut gram = self.gram.clone();
        let mut right = self.right.clone();
        for &&(column, value, sd) in known {
            gram[(column, column)] += 1.0 / (sd * sd);
            right[column] += value / (sd * sd);
        }
        (
            self.scaled(gram),
            right.component_mul(&self.scale),
            &self.scale,
        )
    }

    /// Scales a normal matrix, with the ridge.
    fn scaled(&self, mut gram: DMatrix<f64>) -> DMatrix<f64> {
        for row in 0..gram.nrows() {
            for column in 0..gram.ncols() {
                gram[(row, column)] *= self.scale[row] * self.scale[column];
            }
            gram[(row, row)] += if self.scale[row] > 0.0 { RIDGE } else { 1.0 };
        }
        gram
    }

    /// Squares of some entries of the solution over the variances of their priors.
    pub(super) fn strain(&self, columns: std::ops::Range<usize>) -> f64 {
        columns
            .map(|index| self.known[index].prior * self.solution[index] * self.solution[index])
            .sum()
    }

    /// What `map` makes of the base columns, through the inverse factor of the normal matrix:
    /// columns whose squares are the leverages of the mapped readings.
    pub(super) fn leverage(&self, map: impl Fn(&[f64]) -> Vec<f64>) -> Option<DMatrix<f64>> {
        let mapped: Vec<Vec<f64>> = self
            .known
            .iter()
            .map(|column| map(&column.values))
            .collect();
        let rows = mapped.first()?.len();
        let transposed = DMatrix::from_fn(self.columns(), rows, |column, row| {
            mapped[column][row] * self.scale[column]
        });
        self.factor
            .as_ref()?
            .l_dirty()
            .solve_lower_triangular(&transposed)
    }

    /// Chi-square that some columns explain within blocks.
    pub(super) fn fast_explained(&self, first: usize, count: usize) -> f64 {
        let mut explained = 0.0;
        for (index, column) in self.known.iter().enumerate().skip(first).take(count) {
            explained += 2.0 * self.solution[index] * self.fast.right(column.fast);
            for (other, second) in self.known.iter().enumerate().skip(first).take(count) {
                let product = self.fast.product(column.fast, second.fast);
                explained -= self.solution[index] * self.solution[other] * product;
            }
        }
        explained.max(0.0)
    }

    /// Covariance of some of the solution's entries.
    pub(super) fn covariance(&self, first: usize, count: usize) -> DMatrix<f64> {
        let mut covariance = DMatrix::zeros(count, count);
        for column in 0..count {
            let mut unit = DVector::zeros(self.columns());
            unit[first + column] = 1.0;
            let whole = self.inverse_times(&unit);
            for row in 0..count {
                covariance[(row, column)] = whole[first + row];
            }
        }
        covariance
    }

    /// Makes a candidate's columns base columns.
    pub(super) fn adopt(&mut self, terms: &[Term]) {
        for term in terms {
            let index = self.columns();
            let mut entries: Vec<f64> = (0..index).map(|k| self.with_known(k, term)).collect();
            let alone = self.products(vec![term.clone()]);
            entries.push(alone.own[(0, 0)]);
            self.gram = self.gram.clone().resize(index + 1, index + 1, 0.0);
            for (k, entry) in entries.into_iter().enumerate() {
                self.gram[(index, k)] = entry;
                self.gram[(k, index)] = entry;
            }
            self.right = self.right.clone().push(alone.right[0]);
            let values = self.dense(&term.values);
            self.known.push(Known {
                weighed: self.weights.weigh(&values),
                values,
                prior: 0.0,
                releases: match term.values {
                    Values::Release(base) => Some(base),
                    _ => None,
                },
                fast: term.fast,
            });
        }
        self.solve();
    }

    /// Takes away base columns from `count` on.
    pub(super) fn truncate(&mut self, count: usize) {
        self.known.truncate(count);
        self.gram = self.gram.clone().resize(count, count, 0.0);
        self.right = self.right.rows(0, count).into_owned();
        self.solve();
    }

    /// A base column as a candidate's.
    pub(super) fn term(&self, index: usize) -> Term {
        let column = &self.known[index];
        let values = match column.releases {
            Some(base) => Values::Release(base),
            None => Values::All(column.values.clone()),
        };
        Term {
            values,
            fast: column.fast,
        }
    }

    /// A column's values in all channels.
    pub(super) fn dense(&self, values: &Values) -> Vec<f64> {
        let blocks = self.weights.blocks;
        match values {
            Values::All(values) => values.clone(),
            Values::Channel(channel, own) => {
                let mut all = vec![0.0; self.weighed_reading.len()];
                all[channel * blocks..(channel + 1) * blocks].copy_from_slice(own);
                all
            }
            Values::Release(_) => vec![0.0; self.weighed_reading.len()],
        }
    }
}
