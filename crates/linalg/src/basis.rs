//! An orthonormal basis of the span of a matrix's columns.

use crate::pivoted::thin_basis;
use crate::{LinalgError, Matrix};

/// Orthonormal columns (m x rank) that span the columns of `matrix` (m x n).
///
/// Columns are scaled to unit norm first; directions whose pivot is at most `tolerance` times the
/// largest are left out, so a matrix of zeros gives a basis without columns.
///
/// ```
/// use haptical_linalg::{Matrix, orthonormal_basis};
/// // the third column is the sum of the others
/// let matrix = Matrix::from_fn(4, 3, |row, column| match column {
///     0 => 1.0,
///     1 => row as f64,
///     _ => 1.0 + row as f64,
/// });
/// assert_eq!(orthonormal_basis(&matrix, 1e-9)?.columns(), 2);
/// # Ok::<(), haptical_linalg::LinalgError>(())
/// ```
///
/// # Errors
/// [`LinalgError`] for an empty matrix, an entry that is not finite, or a column norm that
/// overflows; [`LinalgError::OutOfRange`] for a bad tolerance.
pub fn orthonormal_basis(matrix: &Matrix, tolerance: f64) -> Result<Matrix, LinalgError> {
    crate::reduction::at_least_zero("tolerance", tolerance)?;
    matrix.check()?;
    let mut scaled = matrix.clone();
    for column in 0..matrix.columns() {
        let norm = crate::reduction::norm(matrix.column(column));
        if !norm.is_finite() {
            return Err(LinalgError::Overflow {
                what: "a column norm",
            });
        }
        if norm > 0.0 {
            let entries = scaled.column_mut(column).iter_mut();
            entries.for_each(|entry| *entry /= norm);
        }
    }
    Ok(thin_basis(&scaled, tolerance))
}
