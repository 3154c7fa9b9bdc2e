//! One decomposition of a tall matrix, from which every later question is answered.

use crate::error::{check_length, check_rhs};
use crate::pivoted::{PivotedQr, singular_vectors};
use crate::triangle::{TILE_ROWS, Triangle};
use crate::{LinalgError, Matrix, covariance};

/// Rows for each column from which on a matrix is tall.
const TALL: usize = 8;

/// A least-squares problem min |A x - b| reduced to a small triangle.
///
/// A (m x n) is scaled to unit column norms and decomposed once by a column-pivoted QR; one of more than eight rows a column is
/// folded into a triangle before ([`Triangle`]). What is
/// kept is the small factor F (min(m, n) x n, columns in A's order) with F'F = S A'A S and the
/// projected right-hand side, so that |A x - b|^2 = |F S^-1 x - q|^2 + residual. Rank, step,
/// covariance and singular values of any subset of columns then cost O(n^3), whatever m is.
///
/// ```
/// use haptical_linalg::{Matrix, Reduction, RANK_TOLERANCE};
/// // y = 2 + 3 t at t = 0, 1, 2, 3
/// let design = Matrix::from_fn(4, 2, |row, column| if column == 0 { 1.0 } else { row as f64 });
/// let reduction = Reduction::new(&design, &[2.0, 5.0, 8.0, 11.0])?;
/// let solution = reduction.solve(&[0, 1], 0.0, RANK_TOLERANCE)?;
/// assert!((solution.values[1] - 3.0).abs() < 1e-12);
/// # Ok::<(), haptical_linalg::LinalgError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Reduction {
    pub(crate) rows: usize,
    /// min(m, n) x n, of the scaled columns, in the caller's column order.
    pub(crate) factor: Matrix,
    pub(crate) projected: Vec<f64>,
    pub(crate) residual_square: f64,
    pub(crate) column_norms: Vec<f64>,
}

impl Triangle {
    /// The least-squares problem of the triangle, said to have `rows` rows.
    ///
    /// # Errors
    /// [`LinalgError`] for a triangle without columns, an entry that is not finite, or a column norm or a
    /// right-hand side whose square overflows.
    pub fn reduction(&self, rows: usize) -> Result<Reduction, LinalgError> {
        let mut matrix = Matrix::zeros(self.columns(), self.columns());
        for column in 0..self.columns() {
            matrix.column_mut(column)[..=column].copy_from_slice(self.column(column));
        }
        Reduction::from_triangle(matrix, self.projected(), self.rest_square(), rows)
    }
}

impl Reduction {
    /// Reduces `matrix` (m x n) and `rhs` (m).
    ///
    /// # Errors
    /// [`LinalgError`] for an empty matrix, a length that does not fit, an entry that is not finite,
    /// or a column norm or |b|^2 that overflows.
    pub fn new(matrix: &Matrix, rhs: &[f64]) -> Result<Self, LinalgError> {
        matrix.check()?;
        check_rhs(rhs, matrix.rows(), matrix.columns())?;
        // squares that overflow here may not once columns have unit norms
        if let Some(Ok(reduction)) = Self::of_tall(matrix, rhs) {
            return Ok(reduction);
        }
        let (scaled, column_norms) = matrix.clone().into_unit_columns()?;
        let qr = PivotedQr::new(&scaled, rhs);
        let size = qr.factor.rows();
        let mut factor = Matrix::zeros(size, matrix.columns());
        for (position, &column) in qr.pivots.iter().enumerate() {
            factor
                .column_mut(column)
                .copy_from_slice(qr.factor.column(position));
        }
        let (projected, rest) = qr.projected.split_at(size);
        let rest_square = rest.iter().map(|entry| entry * entry).sum();
        Self::of_factor(
            (factor, column_norms),
            projected,
            rest_square,
            matrix.rows(),
        )
    }

    /// The same by the triangle that tiles of rows are folded into, which reads a tall matrix once: pivots are looked for in the triangle.
    fn of_tall(matrix: &Matrix, rhs: &[f64]) -> Option<Result<Self, LinalgError>> {
        let (rows, count) = (matrix.rows(), matrix.columns());
        let is_tall = count > 0 && rows >= (TALL * count).max(TILE_ROWS);
        is_tall.then(|| {
            let columns: Vec<&[f64]> = (0..count).map(|column| matrix.column(column)).collect();
            let mut triangle = Triangle::new(count);
            triangle.fold_rows(&columns, rhs)?;
            triangle.reduction(rows)
        })
    }

    /// A problem that was reduced elsewhere by orthogonal transformations: the upper `triangle` (n x n), what
    /// became of the right-hand side in its rows, and the square of the rest; `rows` is what
    /// [`Reduction::rows`] will say.
    pub(crate) fn from_triangle(
        triangle: Matrix,
        projected: &[f64],
        rest_square: f64,
        rows: usize,
    ) -> Result<Self, LinalgError> {
        triangle.check()?;
        Self::of_factor(triangle.into_unit_columns()?, projected, rest_square, rows)
    }

    /// Refuses a right-hand side whose square overflows.
    fn of_factor(
        (factor, column_norms): (Matrix, Vec<f64>),
        projected: &[f64],
        rest_square: f64,
        rows: usize,
    ) -> Result<Self, LinalgError> {
        let square = projected.iter().map(|entry| entry * entry).sum::<f64>() + rest_square;
        if !square.is_finite() {
            return Err(LinalgError::Overflow {
                what: "the square of the right-hand side",
            });
        }
        Ok(Self {
            rows,
            factor,
            projected: projected.to_vec(),
            residual_square: rest_square,
            column_norms,
        })
    }

    /// Rows of the matrix that was reduced.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Columns of the matrix that was reduced.
    pub fn columns(&self) -> usize {
        self.factor.columns()
    }

    /// Euclidean norms of the unscaled columns.
    pub fn column_norms(&self) -> &[f64] {
        &self.column_norms
    }

    /// The right-hand side in the rows of the small factor, which [`Reduction::scaled_factor`] gives.
    pub fn projected(&self) -> &[f64] {
        &self.projected
    }

    /// Singular values (largest first) of the chosen columns scaled to unit norm, and the right
    /// singular vectors as columns of a `columns.len()` x min(m, `columns.len()`) matrix.
    ///
    /// # Errors
    /// [`LinalgError::Column`] for a bad index, [`LinalgError::Decomposition`] without convergence.
    pub fn singular_values(&self, columns: &[usize]) -> Result<(Vec<f64>, Matrix), LinalgError> {
        singular_vectors(&self.chosen(columns)?)
    }

    /// The inverse of A'A for the chosen columns: the covariance for unit noise.
    ///
    /// # Errors
    /// [`LinalgError::RankDeficient`] instead of a number where the columns are dependent,
    /// [`LinalgError::OutOfRange`] for a bad tolerance, [`LinalgError::Overflow`] for a variance
    /// beyond 1e308.
    pub fn covariance(&self, columns: &[usize], tolerance: f64) -> Result<Matrix, LinalgError> {
        at_least_zero("tolerance", tolerance)?;
        let norms: Vec<f64> = columns
            .iter()
            .map(|&column| self.column_norms.get(column).copied().unwrap_or(0.0))
            .collect();
        covariance::covariance(&self.chosen(columns)?, &norms, tolerance)
    }

    /// The small factor of the chosen columns, each brought to the norm `norms[k]`.
    ///
    /// # Errors
    /// [`LinalgError::Column`] for a bad index, [`LinalgError::Shape`] unless there is one norm per
    /// column, [`LinalgError::NotFinite`] for an entry that is not finite.
    pub fn scaled_factor(&self, columns: &[usize], norms: &[f64]) -> Result<Matrix, LinalgError> {
        check_length("norms of the chosen columns", columns.len(), norms.len())?;
        let mut factor = self.chosen(columns)?;
        for (position, norm) in norms.iter().enumerate() {
            factor
                .column_mut(position)
                .iter_mut()
                .for_each(|entry| *entry *= norm);
        }
        factor.check()?;
        Ok(factor)
    }

    /// Refuses columns that are not there, or chosen twice, or none.
    pub(crate) fn check_chosen(&self, columns: &[usize]) -> Result<(), LinalgError> {
        let available = self.factor.columns();
        let mut seen = vec![false; available];
        for &column in columns {
            match seen.get_mut(column) {
                Some(taken) if !*taken => *taken = true,
                _ => {
                    return Err(LinalgError::Column {
                        column,
                        columns: available,
                    });
                }
            }
        }
        if columns.is_empty() {
            return Err(LinalgError::Empty {
                rows: self.rows,
                columns: 0,
            });
        }
        Ok(())
    }

    pub(crate) fn chosen(&self, columns: &[usize]) -> Result<Matrix, LinalgError> {
        self.check_chosen(columns)?;
        let mut chosen = Matrix::zeros(self.factor.rows(), columns.len());
        for (position, &column) in columns.iter().enumerate() {
            let into = chosen.column_mut(position);
            into.copy_from_slice(self.factor.column(column));
        }
        Ok(chosen)
    }
}

pub(crate) fn at_least_zero(what: &'static str, value: f64) -> Result<(), LinalgError> {
    if value.is_finite() && value >= 0.0 {
        return Ok(());
    }
    Err(LinalgError::OutOfRange {
        what,
        value,
        allowed: "finite and at least 0",
    })
}
