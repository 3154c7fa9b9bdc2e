//! Covariance of an estimate whose rows may each have noise of a size of their own.

use haptical_linalg::Matrix;
use nalgebra::DMatrix;

/// Covariance of an M-estimate, `A^-1 B A^-1` with `A = sum slope d d'` and `B = sum pull d d'` (Huber & Ronchetti, *Robust
/// Statistics*, 2009, corollary 6.7), times n / (n - p) (MacKinnon & White 1985, HC1).
///
/// `derivatives` has a row d for each residual, n of them that pull, and a column for each of p parameters; `slopes` are
/// psi'(u) and `pulls` psi(u)^2, each over what d is weighted by. None where rows are too few or not of full rank.
///
/// ```
/// use haptical_identification::{Matrix, robust_covariance};
/// // the mean of four readings with squares 1, 1, 4 and 4: (10 / 16) 4 / 3
/// let ones = Matrix::from_fn(4, 1, |_, _| 1.0);
/// let found = robust_covariance(&ones, &[1.0; 4], &[1.0, 1.0, 4.0, 4.0]).ok_or("no rank")?;
/// assert!((found[(0, 0)] - 10.0 / 12.0).abs() < 1e-15);
/// # Ok::<(), &str>(())
/// ```
#[must_use]
pub fn robust_covariance(derivatives: &Matrix, slopes: &[f64], pulls: &[f64]) -> Option<Matrix> {
    let (rows, count) = (derivatives.rows(), derivatives.columns());
    let pulling = pulls.iter().filter(|pull| **pull > 0.0).count();
    let freedom = pulling.checked_sub(count).filter(|freedom| *freedom > 0)?;
    // columns of one length: parameters have units of their own
    let norm = |column: usize| {
        let square: f64 = derivatives.column(column).iter().map(|d| d * d).sum();
        (square > 0.0).then(|| square.sqrt())
    };
    let norms: Vec<f64> = (0..count).map(norm).collect::<Option<_>>()?;
    let scaled = DMatrix::from_fn(rows, count, |row, k| derivatives[(row, k)] / norms[k]);
    let product = |by: &[f64]| {
        let mut weighted = scaled.clone();
        for (row, weight) in by.iter().enumerate() {
            weighted.row_mut(row).scale_mut(*weight);
        }
        scaled.tr_mul(&weighted)
    };
    let bread = product(slopes).cholesky()?.inverse();
    let middle = &bread * product(pulls) * &bread;
    let factor = pulling as f64 / freedom as f64;
    let entry = |a: usize, b: usize| factor * middle[(a, b)] / norms[a] / norms[b];
    let found = Matrix::from_fn(count, count, entry);
    let is_sound = |k: usize| found[(k, k)].is_finite() && found[(k, k)] > 0.0;
    (0..count).all(is_sound).then_some(found)
}
