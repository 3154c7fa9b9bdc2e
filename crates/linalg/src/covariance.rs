//! Covariance from a triangle: (R'R)^-1 = R^-1 R^-T, refused where R is singular.

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
    let rank = if factor.rows() == 0 {
        0
    } else {
        qr.rank(tolerance)
    };
    if rank < count {
        return Err(LinalgError::RankDeficient {
            rank,
            columns: count,
        });
    }
    let mut inverse = Matrix::zeros(count, count);
    let mut unit = vec![0.0; count];
    for column in 0..count {
        unit[column] = 1.0;
        inverse
            .column_mut(column)
            .copy_from_slice(&qr.back_substitute(count, &unit));
        unit[column] = 0.0;
    }
    let mut result = Matrix::zeros(count, count);
    for i in 0..count {
        for j in 0..=i {
            let sum: f64 = (0..count).map(|k| inverse[(i, k)] * inverse[(j, k)]).sum();
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
