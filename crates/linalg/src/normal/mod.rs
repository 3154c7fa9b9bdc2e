//! Normal equations: products of columns and a target, which add from rows to rows and are solved for any of the columns.

pub(crate) mod information;

use std::ops::Range;

use crate::lanes::product as dot;
use crate::{Information, Matrix};

/// Products of columns with each other and with a target, summed over rows.
///
/// Sums of parts of the rows add and subtract, so that a fit on all rows but a fold, or on a stretch of a log, needs no further
/// pass over the rows. Columns that are nearly dependent lose half the digits here; [`crate::Reduction`] is for those.
///
/// ```
/// use haptical_linalg::NormalEquations;
/// // y = 2 + 3 t at t = 0, 1, 2 and, apart, at 3
/// let part = |times: &[f64]| {
///     let mut sums = NormalEquations::new(2);
///     times.iter().for_each(|&t| sums.add_row(&[1.0, t, 2.0 + 3.0 * t]));
///     sums
/// };
/// let mut all = part(&[0.0, 1.0, 2.0]);
/// all.add(&part(&[3.0]), 1.0);
/// let fit = all.solve(&[0, 1], |_| 0.0);
/// assert!((fit.coefficients()[1] - 3.0).abs() < 1e-12 && fit.rest_square() < 1e-12);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct NormalEquations {
    /// Columns, and the target behind them.
    size: usize,
    /// Row-major; the lower triangle alone is kept.
    products: Vec<f64>,
}

/// A least-squares fit of some columns to the target.
#[derive(Debug, Clone)]
pub struct NormalSolution {
    columns: Vec<usize>,
    information: Information,
    coefficients: Vec<f64>,
    explained: f64,
    rest_square: f64,
}

impl NormalEquations {
    /// No rows of so many columns.
    pub fn new(columns: usize) -> Self {
        let size = columns + 1;
        Self {
            size,
            products: vec![0.0; size * size],
        }
    }

    /// Of whole columns and a target of one length.
    pub fn from_columns(columns: &[&[f64]], target: &[f64]) -> Self {
        let at = |index: usize| columns.get(index).copied().unwrap_or(target);
        Self::from_products(columns.len(), |a, b| dot(at(a), at(b)))
    }

    /// Of products that are known; `product` is asked for `b <= a`, and the target's index is `columns`.
    pub fn from_products(columns: usize, product: impl Fn(usize, usize) -> f64) -> Self {
        let mut sums = Self::new(columns);
        for a in 0..sums.size {
            for b in 0..=a {
                sums.products[a * sums.size + b] = product(a, b);
            }
        }
        sums
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.size - 1
    }

    /// Adds a row: an entry of each column, and the target's behind them.
    pub fn add_row(&mut self, row: &[f64]) {
        for (a, entry) in row.iter().enumerate() {
            let sums = &mut self.products[a * self.size..a * self.size + a + 1];
            for (sum, other) in sums.iter_mut().zip(row) {
                *sum += entry * other;
            }
        }
    }

    /// Adds sums of the same columns over other rows, so many times.
    pub fn add(&mut self, other: &Self, times: f64) {
        let pairs = self.products.iter_mut().zip(&other.products);
        pairs.for_each(|(sum, other)| *sum += times * other);
    }

    /// The sum of both, the other so many times.
    pub fn plus(&self, other: &Self, times: f64) -> Self {
        let mut sum = self.clone();
        sum.add(other, times);
        sum
    }

    /// Product of two columns; the target's index is [`NormalEquations::columns`].
    pub fn product(&self, a: usize, b: usize) -> f64 {
        self.products[a.max(b) * self.size + a.min(b)]
    }

    /// Square of the target.
    pub fn target_square(&self) -> f64 {
        self.product(self.size - 1, self.size - 1)
    }

    /// The same with some columns times a factor.
    pub fn scaled(&self, columns: Range<usize>, factor: f64) -> Self {
        let factor_of = |index: usize| {
            if columns.contains(&index) {
                factor
            } else {
                1.0
            }
        };
        Self::from_products(self.columns(), |a, b| {
            self.product(a, b) * factor_of(a) * factor_of(b)
        })
    }

    /// The same with a further column, whose products with the columns, itself (at [`NormalEquations::columns`]) and the target
    /// (behind that) are given.
    pub fn with_column(&self, product: impl Fn(usize) -> f64) -> Self {
        let last = self.size - 1;
        // the target moves one place back
        Self::from_products(self.size, |a, b| match (a == last, b == last) {
            (true, _) => product(b),
            (_, true) => product(a),
            _ => self.product(a - usize::from(a > last), b - usize::from(b > last)),
        })
    }

    /// The same with further columns that are sums of others: `(column, factor)` each.
    pub fn with_sums(&self, sums: &[&[(usize, f64)]]) -> Self {
        let last = self.size - 1;
        let along = |terms: &[(usize, f64)], index: usize| -> f64 {
            let terms = terms.iter();
            let products = terms.map(|&(column, factor)| factor * self.product(column, index));
            products.sum()
        };
        // a sum, or where a column or the target was
        let place = |index: usize| match index.checked_sub(last) {
            Some(sum) => sums.get(sum).ok_or(last),
            None => Err(index),
        };
        Self::from_products(last + sums.len(), |a, b| match (place(a), place(b)) {
            (Err(a), Err(b)) => self.product(a, b),
            (Ok(sum), Err(other)) | (Err(other), Ok(sum)) => along(sum, other),
            (Ok(a), Ok(b)) => {
                let terms = a.iter().map(|&(column, factor)| factor * along(b, column));
                terms.sum()
            }
        })
    }

    /// Squares that given coefficients of some columns leave of the target; rounding may not make them negative.
    pub fn left(&self, columns: &[usize], coefficients: &[f64]) -> f64 {
        let target = self.size - 1;
        let mut left = self.target_square();
        for (&a, x) in columns.iter().zip(coefficients) {
            let pairs = columns.iter().zip(coefficients);
            let product: f64 = pairs.map(|(&b, y)| self.product(a, b) * y).sum();
            left += x * (product - 2.0 * self.product(a, target));
        }
        left.max(0.0)
    }

    /// Least squares for some columns. `known(column)` is added to its square: one over the variance that is known of its
    /// coefficient beforehand, or a ridge. A column that adds nothing to those before it has the coefficient 0.
    pub fn solve(&self, columns: &[usize], known: impl Fn(usize) -> f64) -> NormalSolution {
        let entry = |a: usize, b: usize| {
            let known = if a == b { known(columns[a]) } else { 0.0 };
            self.product(columns[a], columns[b]) + known
        };
        // a column that depends on those before it leaves rounding
        let information = Information::scaled(columns.len(), f64::EPSILON, entry, dot);
        let along = information.along_by(dot, |a| self.product(columns[a], self.size - 1));
        let explained = dot(&along, &along);
        NormalSolution {
            columns: columns.to_vec(),
            rest_square: (self.target_square() - explained).max(0.0),
            explained,
            coefficients: information.coefficients(along),
            information,
        }
    }

    /// Products of `others` with each other in what a fit's columns leave of them (a Schur complement).
    pub fn across(&self, fit: &NormalSolution, others: &[usize]) -> Matrix {
        let along: Vec<Vec<f64>> = (others.iter())
            .map(|&other| {
                fit.information
                    .along_by(dot, |a| self.product(fit.columns[a], other))
            })
            .collect();
        Matrix::from_fn(others.len(), others.len(), |a, b| {
            self.product(others[a], others[b]) - dot(&along[a], &along[b])
        })
    }
}

impl NormalSolution {
    /// Coefficients in the order in which the columns were chosen.
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// Squares of the target that the columns explain; of coefficients with prior knowledge, what the cost falls by.
    pub fn explained(&self) -> f64 {
        self.explained
    }

    /// Squares of the target less [`NormalSolution::explained`].
    pub fn rest_square(&self) -> f64 {
        self.rest_square
    }

    /// Inverse of the products times a vector, in the order of the columns.
    pub fn inverse_times(&self, right: &[f64]) -> Vec<f64> {
        let along = self.information.along_by(dot, |a| right[a]);
        self.information.coefficients(along)
    }

    /// Inverse of the products: the coefficients' covariance for noise of unit size. Zero of a column that adds nothing.
    pub fn inverse(&self) -> Matrix {
        let count = self.columns.len();
        let mut inverse = Matrix::zeros(count, count);
        let mut unit = vec![0.0; count];
        for column in 0..count {
            unit[column] = 1.0;
            inverse
                .column_mut(column)
                .copy_from_slice(&self.inverse_times(&unit));
            unit[column] = 0.0;
        }
        inverse
    }
}
