//! Variances of columns whose independence an explicit inverse proves, without a pivoted decomposition.

use haptical_linalg::{LinalgError, OrderedColumns};

/// What the inverse of a triangle says.
#[derive(Debug)]
pub(crate) struct Variances {
    /// Diagonal of (A^T A)^-1 for the chosen columns, in their order.
    pub(crate) variances: Vec<f64>,
    /// Lower bound of the smallest singular value of the columns at unit norm.
    pub(crate) least: f64,
}

/// Variances of the independent columns for unit noise, as the diagonal of [`haptical_linalg::Reduction::covariance`].
///
/// The columns at unit norm are orthogonalised to a triangle R. As the smallest
/// singular value is 1 / |R^-1|_2, and |R^-1|_2 at most the Frobenius norm, the inverse itself proves
/// that a pivoted QR would find no pivot below it; where it proves nothing, the pivoted QR decides.
///
/// # Errors
/// As [`haptical_linalg::Reduction::covariance`].
pub(crate) fn variances(
    ordered: &mut OrderedColumns<'_>,
    tolerance: f64,
) -> Result<Variances, LinalgError> {
    let reduction = ordered.reduction();
    let columns: Vec<usize> = ordered.independent().collect();
    let squares = ordered.inverse_row_squares();
    let least = 1.0 / squares.iter().sum::<f64>().sqrt();
    let variances: Vec<f64> = squares
        .iter()
        .zip(&columns)
        .map(|(square, &column)| {
            let norm = reduction.column_norms()[column];
            square / norm / norm
        })
        .collect();
    let is_finite = variances.iter().all(|variance| variance.is_finite());
    // pivots are at most 1, the norm of a column; twice, as the bound is rounded itself
    if !columns.is_empty() && is_finite && least > 2.0 * tolerance {
        return Ok(Variances { variances, least });
    }
    let covariance = reduction.covariance(&columns, tolerance)?;
    let variances: Vec<f64> = (0..columns.len()).map(|k| covariance[(k, k)]).collect();
    let squares = variances.iter().zip(&columns).map(|(variance, &column)| {
        let norm = reduction.column_norms()[column];
        variance * norm * norm
    });
    let least = 1.0 / squares.sum::<f64>().sqrt();
    Ok(Variances { variances, least })
}
