//! Variances of columns whose independence an explicit inverse proves, without a pivoted decomposition.

use haptical_linalg::{LinalgError, Reduction};

use crate::lanes::{product, subtract};

/// What the inverse of a triangle says.
#[derive(Debug)]
pub(crate) struct Variances {
    /// Diagonal of (A^T A)^-1 for the chosen columns, in their order.
    pub(crate) variances: Vec<f64>,
    /// Lower bound of the smallest singular value of the columns at unit norm.
    pub(crate) least: f64,
}

/// Variances of the chosen columns for unit noise, as the diagonal of [`Reduction::covariance`].
///
/// The columns at unit norm are brought to a triangle R by Householder reflections. As the smallest
/// singular value is 1 / |R^-1|_2, and |R^-1|_2 at most the Frobenius norm, the inverse itself proves
/// that a pivoted QR would find no pivot below it; where it proves nothing, the pivoted QR decides.
///
/// # Errors
/// As [`Reduction::covariance`].
pub(crate) fn variances(
    reduction: &Reduction,
    columns: &[usize],
    tolerance: f64,
) -> Result<Variances, LinalgError> {
    let ones = vec![1.0; columns.len()];
    let factor = reduction.scaled_factor(columns, &ones)?;
    let rows = factor.rows();
    if rows >= columns.len() {
        let entries = (0..columns.len()).flat_map(|column| factor.column(column));
        let mut entries: Vec<f64> = entries.copied().collect();
        triangularise(&mut entries, rows, columns.len());
        let squares = inverse_row_squares(&entries, rows, columns.len());
        let least = 1.0 / squares.iter().sum::<f64>().sqrt();
        let variances: Vec<f64> = squares
            .iter()
            .zip(columns)
            .map(|(square, &column)| {
                let norm = reduction.column_norms()[column];
                square / norm / norm
            })
            .collect();
        let is_finite = variances.iter().all(|variance| variance.is_finite());
        // pivots are at most 1, the norm of a column; twice, as the bound is rounded itself
        if is_finite && least > 2.0 * tolerance {
            return Ok(Variances { variances, least });
        }
    }
    let covariance = reduction.covariance(columns, tolerance)?;
    let variances: Vec<f64> = (0..columns.len()).map(|k| covariance[(k, k)]).collect();
    let squares = variances.iter().zip(columns).map(|(variance, &column)| {
        let norm = reduction.column_norms()[column];
        variance * norm * norm
    });
    let least = 1.0 / squares.sum::<f64>().sqrt();
    Ok(Variances { variances, least })
}

/// Makes a matrix, column by column, upper triangular by Householder reflections from the left
/// (Golub & Van Loan, *Matrix Computations*, section 5.2); what is below is not written.
fn triangularise(entries: &mut [f64], rows: usize, columns: usize) {
    for index in 0..columns.min(rows - 1) {
        let (left, right) = entries.split_at_mut((index + 1) * rows);
        let own = &mut left[index * rows + index..];
        let below = product(&own[1..], &own[1..]);
        if below == 0.0 {
            continue;
        }
        let alpha = own[0];
        let norm = (alpha * alpha + below).sqrt();
        let beta = if alpha >= 0.0 { -norm } else { norm };
        // v = (alpha - beta, below), H = I - v v^T / (beta (beta - alpha))
        own[0] = alpha - beta;
        let scale = 1.0 / (beta * (beta - alpha));
        for other in right.chunks_exact_mut(rows) {
            let other = &mut other[index..];
            let change = scale * product(own, other);
            subtract(other, change, own);
        }
        own[0] = beta;
    }
}

/// Squared norms of the rows of R^-1, R the leading triangle.
fn inverse_row_squares(entries: &[f64], rows: usize, columns: usize) -> Vec<f64> {
    let mut squares = vec![0.0; columns];
    let mut solved = vec![0.0; columns];
    for index in 0..columns {
        // R x = e_index has nothing beyond its entry `index`
        solved[..index].fill(0.0);
        solved[index] = 1.0;
        for column in (0..=index).rev() {
            let above = &entries[column * rows..][..=column];
            let value = solved[column] / above[column];
            solved[column] = value;
            subtract(&mut solved[..column], value, &above[..column]);
            squares[column] += value * value;
        }
    }
    squares
}
