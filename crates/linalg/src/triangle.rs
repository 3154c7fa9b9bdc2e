//! The triangle that rows are folded into, and the sum of squares that it does not explain.

use std::cell::RefCell;

use pulp::Arch;

use crate::aligned::Aligned;
use crate::error::check_length;
use crate::fold::Fold;
use crate::{LinalgError, Matrix};

/// Rows of a tile: 28 columns of so many numbers and the residuals fill 59 kB. Twice the rows halve what every column
/// costs once per tile, and the four columns that are in use at a time, 8 kB, stay in the first-level cache; 128 rows
/// take 5 % longer where that cache has 48 kB (crates/batch/README.md).
pub const TILE_ROWS: usize = 256;
/// Rows are filled up to a multiple of this, whatever the processor's lanes are.
const ROW_QUANTUM: usize = 16;

/// `[J r]` of any number of rows, reduced by orthogonal transformations: with k columns of derivatives
/// an upper triangle R (k x k), q = Q^T r (k) and the rest of |r|^2, so that for every x
/// |J x - r|^2 = |R x - q|^2 + rest.
///
/// ```
/// use haptical_linalg::Triangle;
/// // y = 2 + 3 t: columns 1 and t
/// let mut triangle = Triangle::new(2);
/// triangle.fold_rows(&[&[1.0, 1.0, 1.0, 1.0], &[0.0, 1.0, 2.0, 3.0]], &[2.0, 5.0, 8.0, 11.0])?;
/// let slope = triangle.projected()[1] / triangle.entry(1, 1);
/// assert!((slope - 3.0).abs() < 1e-14);
/// assert!(triangle.rest_square() < 1e-25);
/// # Ok::<(), haptical_linalg::LinalgError>(())
/// ```
#[derive(Debug, Default, Clone)]
pub struct Triangle {
    columns: usize,
    /// Column-major, `columns` rows and `columns + 1` columns; below the diagonal it is zero.
    entries: Aligned,
    rest_square: f64,
    rows: usize,
}

thread_local! {
    /// Room for the rows that are being folded, kept from call to call.
    static TILE: RefCell<Aligned> = RefCell::default();
}

impl Triangle {
    /// A triangle of no rows over `columns` columns of derivatives.
    pub fn new(columns: usize) -> Self {
        Self {
            columns,
            entries: Aligned::zeros(columns * (columns + 1)),
            rest_square: 0.0,
            rows: 0,
        }
    }

    /// Columns of derivatives.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Rows folded so far.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Entry of R.
    ///
    /// # Panics
    /// For a row or a column that it has not.
    pub fn entry(&self, row: usize, column: usize) -> f64 {
        assert!(row < self.columns && column < self.columns, "R is square");
        self.entries.as_slice()[column * self.columns + row]
    }

    /// Column of R, down to its diagonal.
    pub fn column(&self, column: usize) -> &[f64] {
        &self.entries.as_slice()[column * self.columns..][..=column]
    }

    /// q = Q^T r, one entry per column.
    pub fn projected(&self) -> &[f64] {
        &self.entries.as_slice()[self.columns * self.columns..][..self.columns]
    }

    /// Sum of squares of the residuals that no step can lower.
    pub fn rest_square(&self) -> f64 {
        self.rest_square
    }

    /// Sum of squares of the residuals, |q|^2 + rest.
    pub fn cost(&self) -> f64 {
        self.projected()
            .iter()
            .map(|entry| entry * entry)
            .sum::<f64>()
            + self.rest_square
    }

    /// Writes it as residuals and derivatives of a problem: residuals q and
    /// sqrt(rest), rest zero; derivatives R over zeros.
    ///
    /// # Panics
    /// For fewer residuals, or rows or columns of the matrix, than it has columns (one residual more).
    pub fn write_into(&self, residuals: &mut [f64], jacobian: Option<&mut Matrix>) {
        let columns = self.columns;
        residuals.fill(0.0);
        residuals[..columns].copy_from_slice(self.projected());
        residuals[columns] = self.rest_square.sqrt();
        if let Some(matrix) = jacobian {
            for column in 0..columns {
                let into = matrix.column_mut(column);
                into.fill(0.0);
                let from = &self.entries.as_slice()[column * columns..][..=column];
                into[..=column].copy_from_slice(from);
            }
        }
    }

    /// Folds rows given as columns of derivatives and residuals.
    ///
    /// # Errors
    /// [`LinalgError::Shape`] for slices that do not fit; [`LinalgError::Overflow`] for entries that are
    /// not finite or whose squares are not: then the triangle is of no further use.
    pub fn fold_rows(&mut self, columns: &[&[f64]], residuals: &[f64]) -> Result<(), LinalgError> {
        check_length("columns to fold", self.columns, columns.len())?;
        for column in columns {
            check_length("a column to fold", residuals.len(), column.len())?;
        }
        TILE.with_borrow_mut(|tile| {
            tile.reserve((self.columns + 1) * TILE_ROWS);
            let mut first = 0;
            while first < residuals.len() {
                let rows = (residuals.len() - first).min(TILE_ROWS);
                let used = rows.next_multiple_of(ROW_QUANTUM).min(TILE_ROWS);
                let into = tile.as_mut_slice().chunks_exact_mut(TILE_ROWS);
                for (into, from) in into.zip(columns.iter().chain([&residuals])) {
                    into[..rows].copy_from_slice(&from[first..first + rows]);
                    into[rows..used].fill(0.0);
                }
                self.fold_tile(tile.as_mut_slice(), rows);
                first += rows;
            }
        });
        self.check()
    }

    /// Folds the first `rows` rows of a tile (columns `TILE_ROWS` apart, the last the residuals; rows
    /// up to the next multiple of the quantum are there and zero), which is destroyed.
    fn fold_tile(&mut self, tile: &mut [f64], rows: usize) {
        let columns = self.columns;
        let fold = Fold {
            triangle: &mut self.entries.as_mut_slice()[..columns * (columns + 1)],
            columns,
            tile,
            stride: TILE_ROWS,
            rows: rows.next_multiple_of(ROW_QUANTUM).min(TILE_ROWS),
        };
        self.rest_square += Arch::new().dispatch(fold);
        self.rows += rows;
    }

    /// The triangle as rows: one more than it has columns of derivatives, the last column the residuals.
    pub fn as_rows(&self) -> Matrix {
        let count = self.columns;
        let mut rows = Matrix::zeros(count + 1, count + 1);
        for column in 0..count {
            rows.column_mut(column)[..=column].copy_from_slice(self.column(column));
        }
        let last = rows.column_mut(count);
        last[..count].copy_from_slice(self.projected());
        last[count] = self.rest_square.sqrt();
        rows
    }

    /// Folds another triangle of the same columns.
    ///
    /// # Errors
    /// As [`Triangle::fold_rows`].
    pub fn merge(&mut self, other: &Self) -> Result<(), LinalgError> {
        let all = self.rows + other.rows;
        let rows = other.as_rows();
        let columns: Vec<&[f64]> = (0..other.columns)
            .map(|column| rows.column(column))
            .collect();
        self.fold_rows(&columns, rows.column(other.columns))?;
        self.rows = all;
        Ok(())
    }

    /// Refuses entries that are not finite.
    fn check(&self) -> Result<(), LinalgError> {
        let used = &self.entries.as_slice()[..self.columns * (self.columns + 1)];
        // some at a time without a way out between them, so that they are looked at in lanes
        let mut parts = used.chunks(64);
        let is_finite = parts.all(|part| part.iter().fold(true, |all, x| all & x.is_finite()));
        if is_finite && self.cost().is_finite() {
            Ok(())
        } else {
            Err(LinalgError::Overflow {
                what: "the sum of squares of weighted residuals or derivatives",
            })
        }
    }
}
