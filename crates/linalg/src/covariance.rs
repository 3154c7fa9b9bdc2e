//! Covariance from a triangle: (R'R)^-1 = R^-1 R^-T, refused where R is singular.

use crate::lanes::{product, subtract};
use crate::pivoted::PivotedQr;
use crate::{LinalgError, Matrix};

/// The inverse Gram matrix of `factor`'s columns, which had been divided by `norms`.
pub(crate) fn covariance(
    factor: &Matrix,
    norms: &[f64],
    tolerance: f64,
) -> Result<Matrix, LinalgError> {
    let count = factor.columns();
    let qr = PivotedQr::new(factor, &vec![0.0; factor.rows()]);
    let rank = qr.rank(tolerance);
    if rank < count {
        return Err(LinalgError::RankDeficient {
            rank,
            columns: count,
        });
    }
    // row i of R^-1 from its diagonal on; before that it is zero
    let mut rows = Matrix::zeros(count, count);
    let mut solved = vec![0.0; count];
    for column in 0..count {
        // R x = e_column has nothing beyond its entry `column`
        solved[..column].fill(0.0);
        solved[column] = 1.0;
        for row in (0..=column).rev() {
            let above = &qr.factor.column(row)[..=row];
            let value = solved[row] / above[row];
            rows[(column, row)] = value;
            subtract(&mut solved[..row], value, &above[..row]);
        }
    }
    let mut result = Matrix::zeros(count, count);
    for i in 0..count {
        for j in 0..=i {
            let sum = product(&rows.column(i)[i..], &rows.column(j)[i..]);
            let (a, b) = (qr.pivots[i], qr.pivots[j]);
            let value = sum / norms[a] / norms[b];
            if !value.is_finite() {
                return Err(LinalgError::Overflow { what: "a variance" });
            }
            result[(a, b)] = value;
            result[(b, a)] = value;
        }
    }
    Ok(result)
}
