//! A decomposition that keeps its orthonormal basis: projections and many right-hand sides.

use crate::error::check_rhs;
use crate::pivoted::{back_substitute, thin_factors};
use crate::reduction::at_least_zero;
use crate::{LinalgError, Matrix};

/// A = Q R of a tall matrix with its basis Q (m x rank), for projections and for right-hand sides that are
/// not known yet. [`crate::Reduction`] needs less memory where there is one right-hand side.
///
/// ```
/// use haptical_linalg::{Matrix, OrthonormalBasis};
/// // the third column is the sum of the others
/// let matrix = Matrix::from_fn(4, 3, |row, column| match column {
///     0 => 1.0,
///     1 => row as f64,
///     _ => 1.0 + row as f64,
/// });
/// let basis = OrthonormalBasis::new(&matrix, 1e-9)?;
/// assert_eq!(basis.directions().columns(), 2);
/// let x = basis.solve(&[1.0, 3.0, 5.0, 7.0])?;
/// assert!((x[0] + x[2] - 1.0).abs() < 1e-12 && (x[1] + x[2] - 2.0).abs() < 1e-12);
/// # Ok::<(), haptical_linalg::LinalgError>(())
/// ```
#[derive(Debug, Clone)]
pub struct OrthonormalBasis {
    directions: Matrix,
    /// The triangle R, rank x rank.
    triangle: Matrix,
    /// The matrix's column at each of the triangle's.
    pivots: Vec<usize>,
    norms: Vec<f64>,
}

impl OrthonormalBasis {
    /// Decomposes `matrix` (m x n). Columns are scaled to unit norm first; directions whose pivot is at
    /// most `tolerance` times the largest are left out, so a matrix of zeros has no directions.
    ///
    /// # Errors
    /// [`LinalgError`] for an empty matrix, an entry that is not finite, or a column norm that
    /// overflows; [`LinalgError::OutOfRange`] for a bad tolerance.
    pub fn new(matrix: &Matrix, tolerance: f64) -> Result<Self, LinalgError> {
        at_least_zero("tolerance", tolerance)?;
        matrix.check()?;
        let (scaled, norms) = matrix.clone().into_unit_columns()?;
        let (directions, triangle, pivots) = thin_factors(&scaled, tolerance);
        Ok(Self {
            directions,
            triangle,
            pivots,
            norms,
        })
    }

    /// Orthonormal columns (m x rank) that span the matrix's.
    pub fn directions(&self) -> &Matrix {
        &self.directions
    }

    /// The x of least |A x - b|, zero for columns that the rank cut.
    ///
    /// # Errors
    /// [`LinalgError::Shape`] for another length, [`LinalgError::NotFinite`] for an entry that is not
    /// finite, [`LinalgError::Overflow`] for a value beyond 1e308.
    pub fn solve(&self, rhs: &[f64]) -> Result<Vec<f64>, LinalgError> {
        let basis = &self.directions;
        check_rhs(rhs, basis.rows(), self.norms.len())?;
        let projected: Vec<f64> = (0..basis.columns())
            .map(|k| basis.column(k).iter().zip(rhs).map(|(q, b)| q * b).sum())
            .collect();
        let known = back_substitute(&self.triangle, &projected);
        let mut solution = vec![0.0; self.norms.len()];
        for (value, &column) in known.iter().zip(&self.pivots) {
            solution[column] = value / self.norms[column];
        }
        if solution.iter().any(|value| !value.is_finite()) {
            return Err(LinalgError::Overflow { what: "a solution" });
        }
        Ok(solution)
    }
}
