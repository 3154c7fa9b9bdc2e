//! Least-squares steps from a reduction: plain, truncated and damped.

use crate::error::check_length;
use crate::pivoted::{PivotedQr, back_substitute};
use crate::reduction::at_least_zero;
use crate::{LinalgError, Matrix, Reduction};

/// A least-squares solution.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// One value per chosen column, in the units of the unscaled problem; zero where the rank cut.
    pub values: Vec<f64>,
    /// Numerical rank of the chosen (and, if damped, augmented) columns.
    pub rank: usize,
    /// |A x - b|^2 at the solution, without the damping term.
    pub residual_square: f64,
    /// |b|^2 - |A x - b|^2 without the cancellation of that subtraction.
    pub explained_square: f64,
}

impl Reduction {
    /// Minimises |A x - b|^2 + `damping` |D x|^2 over the chosen columns, the others being zero,
    /// with D the diagonal of column norms (Marquardt's scaling; Moré 1978, section 5).
    ///
    /// The step comes from a pivoted QR of the triangle with sqrt(`damping`) rows below it, never
    /// from the normal equations. Directions whose pivot is at most `tolerance` times the largest
    /// are left at zero; [`Solution::rank`] says how many remained.
    ///
    /// # Errors
    /// [`LinalgError::Column`] for a bad index, [`LinalgError::OutOfRange`] for a damping or a
    /// tolerance that is negative or not finite, [`LinalgError::Overflow`] for a value beyond 1e308.
    pub fn solve(
        &self,
        columns: &[usize],
        damping: f64,
        tolerance: f64,
    ) -> Result<Solution, LinalgError> {
        self.solve_weighted(columns, damping, &vec![1.0; columns.len()], tolerance)
    }

    /// As [`Reduction::solve`] with the damping term `damping` |W D x|^2, W the diagonal of
    /// `weights` (one per chosen column).
    ///
    /// # Errors
    /// As [`Reduction::solve`], [`LinalgError::Shape`] for another number of weights and
    /// [`LinalgError::OutOfRange`] for a weight that is negative or not finite.
    pub fn solve_weighted(
        &self,
        columns: &[usize],
        damping: f64,
        weights: &[f64],
        tolerance: f64,
    ) -> Result<Solution, LinalgError> {
        check_length("damping weights", columns.len(), weights.len())?;
        at_least_zero("damping", damping)?;
        at_least_zero("tolerance", tolerance)?;
        for &weight in weights {
            at_least_zero("damping weight", weight)?;
            if !(weight * damping.sqrt()).is_finite() {
                return Err(LinalgError::Overflow {
                    what: "a damping weight",
                });
            }
        }
        let chosen = self.chosen(columns)?;
        let (size, count) = (chosen.rows(), columns.len());
        let extra = if damping > 0.0 { count } else { 0 };
        let root = damping.sqrt();
        // Unit columns again: a heavy weight must not make the others look negligible.
        let lengths: Vec<f64> = weights
            .iter()
            .map(|weight| {
                if extra > 0 {
                    (root * weight).hypot(1.0)
                } else {
                    1.0
                }
            })
            .collect();
        let stacked = Matrix::from_fn(size + extra, count, |row, column| {
            if row < size {
                chosen[(row, column)] / lengths[column]
            } else if row - size == column {
                root * weights[column] / lengths[column]
            } else {
                0.0
            }
        });
        let mut rhs = self.projected.clone();
        rhs.resize(size + extra, 0.0);
        let qr = PivotedQr::new(&stacked, &rhs);
        let rank = qr.rank(tolerance);
        let leading = back_substitute(&qr.factor, &qr.projected[..rank]);
        let mut scaled = vec![0.0; count];
        for (position, value) in leading.into_iter().enumerate() {
            let column = qr.pivots[position];
            scaled[column] = value / lengths[column];
        }
        let fitted = chosen.times(&scaled)?;
        let (mut misfit, mut explained_square) = (0.0, 0.0);
        for (have, fit) in self.projected.iter().zip(&fitted) {
            misfit += (have - fit) * (have - fit);
            explained_square += fit * (2.0 * have - fit);
        }
        let values: Vec<f64> = scaled
            .iter()
            .zip(columns)
            .map(|(value, &column)| match self.column_norms[column] {
                norm if norm > 0.0 => value / norm,
                _ => 0.0,
            })
            .collect();
        let residual_square = self.residual_square + misfit;
        if !residual_square.is_finite() || values.iter().any(|value| !value.is_finite()) {
            return Err(LinalgError::Overflow { what: "a solution" });
        }
        Ok(Solution {
            values,
            rank,
            residual_square,
            explained_square,
        })
    }
}
