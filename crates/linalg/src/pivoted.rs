//! The guarded column-pivoted QR: the one place where faer decomposes a dense matrix.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::householder;
use faer::{Conj, Mat, Par};

use crate::{LinalgError, Matrix};

/// A P' = Q R of a checked matrix, with Q' applied to one right-hand side.
#[derive(Debug)]
pub(crate) struct PivotedQr {
    /// min(rows, columns) x columns, upper trapezoidal, columns in pivot order.
    pub(crate) factor: Matrix,
    /// Original column at each pivot position.
    pub(crate) pivots: Vec<usize>,
    /// The whole of Q' b.
    pub(crate) projected: Vec<f64>,
}

impl PivotedQr {
    /// Decomposes `matrix`, whose entries the caller has checked to be finite.
    pub(crate) fn new(matrix: &Matrix, rhs: &[f64]) -> Self {
        let (rows, columns) = (matrix.rows(), matrix.columns());
        let size = rows.min(columns);
        // faer divides by the largest column norm: an all-zero matrix would come back as NaN.
        if matrix.is_zero() {
            return Self {
                factor: Matrix::zeros(size, columns),
                pivots: (0..columns).collect(),
                projected: rhs.to_vec(),
            };
        }
        let qr = matrix.as_faer().col_piv_qr();
        let mut projected = Mat::from_fn(rows, 1, |row, _| rhs[row]);
        let block_size = qr.Q_coeff().nrows();
        let scratch =
            householder::apply_block_householder_sequence_transpose_on_the_left_in_place_scratch::<
                f64,
            >(rows, block_size, 1);
        householder::apply_block_householder_sequence_transpose_on_the_left_in_place_with_conj(
            qr.Q_basis(),
            qr.Q_coeff(),
            Conj::Yes,
            projected.as_mut(),
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(scratch)),
        );
        Self {
            factor: upper(qr.R(), size, columns),
            pivots: qr.P().arrays().0.to_vec(),
            projected: (0..rows).map(|row| projected[(row, 0)]).collect(),
        }
    }

    /// Rank of the factor ([`rank_of_diagonal`]).
    pub(crate) fn rank(&self, tolerance: f64) -> usize {
        let diagonal = (0..self.factor.rows()).map(|index| self.factor[(index, index)]);
        rank_of_diagonal(diagonal, tolerance)
    }
}

/// Index of the first diagonal entry that is negligible against the largest.
///
/// The diagonal falls monotonically only above the rounding noise, so the rank is the *first* index below the
/// tolerance, never a count of entries above it.
fn rank_of_diagonal(diagonal: impl ExactSizeIterator<Item = f64>, tolerance: f64) -> usize {
    let size = diagonal.len();
    let mut diagonal = diagonal.map(f64::abs).peekable();
    let largest = diagonal.peek().copied().unwrap_or(0.0);
    let first = diagonal.position(|entry| entry == 0.0 || entry <= tolerance * largest);
    first.unwrap_or(size)
}

/// Solves the leading triangle of `factor`, as large as `rhs` is long.
pub(crate) fn back_substitute(factor: &Matrix, rhs: &[f64]) -> Vec<f64> {
    let mut solution = rhs.to_vec();
    for row in (0..rhs.len()).rev() {
        let mut value = solution[row];
        for (column, known) in solution.iter().enumerate().skip(row + 1) {
            value -= factor[(row, column)] * known;
        }
        solution[row] = value / factor[(row, row)];
    }
    solution
}

/// Leading columns of Q (rows x rank), the leading triangle of R (rank x rank) and the original column at each pivot
/// position of a checked matrix.
pub(crate) fn thin_factors(matrix: &Matrix, tolerance: f64) -> (Matrix, Matrix, Vec<usize>) {
    let (rows, columns) = (matrix.rows(), matrix.columns());
    if matrix.is_zero() {
        return (Matrix::zeros(rows, 0), Matrix::zeros(0, 0), Vec::new());
    }
    let qr = matrix.as_faer().col_piv_qr();
    let (q, r) = (qr.compute_thin_Q(), qr.R());
    let diagonal = (0..rows.min(columns)).map(|index| r[(index, index)]);
    let rank = rank_of_diagonal(diagonal, tolerance);
    (
        Matrix::from_fn(rows, rank, |row, column| q[(row, column)]),
        upper(r, rank, rank),
        qr.P().arrays().0.to_vec(),
    )
}

/// What of R is above and on its diagonal, in its leading rows and columns.
fn upper(r: faer::MatRef<'_, f64>, rows: usize, columns: usize) -> Matrix {
    Matrix::from_fn(rows, columns, |row, column| {
        if row <= column { r[(row, column)] } else { 0.0 }
    })
}

/// Singular values, largest first, of a checked matrix.
pub(crate) fn singular_values(matrix: &Matrix) -> Result<Vec<f64>, LinalgError> {
    let count = matrix.rows().min(matrix.columns());
    let Some((scaled, largest)) = at_unit_size(matrix) else {
        return Ok(vec![0.0; count]);
    };
    let values = scaled.as_faer().singular_values();
    let mut values = values.map_err(|_| unsuccessful(matrix))?;
    values.iter_mut().for_each(|value| *value *= largest);
    all_finite(values)
}

/// Singular values, largest first, and the right singular vectors as columns.
pub(crate) fn singular_vectors(matrix: &Matrix) -> Result<(Vec<f64>, Matrix), LinalgError> {
    let columns = matrix.columns();
    let count = matrix.rows().min(columns);
    let Some((scaled, largest)) = at_unit_size(matrix) else {
        let identity = |row, column| f64::from(u8::from(row == column));
        return Ok((vec![0.0; count], Matrix::from_fn(columns, count, identity)));
    };
    let svd = scaled.as_faer().thin_svd();
    let svd = svd.map_err(|_| unsuccessful(matrix))?;
    let values = (0..count).map(|index| svd.S()[index] * largest).collect();
    let vectors = Matrix::from_fn(columns, count, |row, column| svd.V()[(row, column)]);
    Ok((all_finite(values)?, vectors))
}

/// The matrix over its largest entry, and that: squares of 1e300 or 1e-300 inside the iteration would overflow or
/// vanish. None for a matrix of zeros.
fn at_unit_size(matrix: &Matrix) -> Option<(Matrix, f64)> {
    let largest = (0..matrix.columns())
        .flat_map(|column| matrix.column(column))
        .fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
    let entry = |row, column| matrix[(row, column)] / largest;
    (largest > 0.0).then(|| {
        (
            Matrix::from_fn(matrix.rows(), matrix.columns(), entry),
            largest,
        )
    })
}

fn unsuccessful(matrix: &Matrix) -> LinalgError {
    LinalgError::Decomposition {
        what: "singular value decomposition",
        rows: matrix.rows(),
        columns: matrix.columns(),
    }
}

fn all_finite(values: Vec<f64>) -> Result<Vec<f64>, LinalgError> {
    if values.iter().all(|value| value.is_finite()) {
        Ok(values)
    } else {
        Err(LinalgError::Overflow {
            what: "a singular value",
        })
    }
}
