//! Columns of which each is zero but for a range of its rows.

mod direction;

use crate::LinalgError;
use crate::error::check_length;

pub use self::direction::Direction;

/// A tall matrix whose columns have few rows in common, as those of parts of a device that do not know of each other:
/// of each column only the range is kept in which it may differ from zero.
///
/// ```
/// use haptical_linalg::{Direction, SparseColumns};
/// let columns = vec![Direction::from_part(0, vec![1.0, 2.0]), Direction::from_part(3, vec![4.0])];
/// let matrix = SparseColumns::new(5, columns);
/// assert_eq!(matrix.times(&[1.0, 0.5])?, [1.0, 2.0, 0.0, 2.0, 0.0]);
/// assert_eq!(matrix.dense(1), [0.0, 0.0, 0.0, 4.0, 0.0]);
/// # Ok::<(), haptical_linalg::LinalgError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SparseColumns {
    rows: usize,
    columns: Vec<Direction>,
}

impl SparseColumns {
    /// Columns of so many rows; entries of a column beyond them are left out.
    pub fn new(rows: usize, columns: Vec<Direction>) -> Self {
        Self { rows, columns }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns.len()
    }

    /// One column.
    ///
    /// # Panics
    /// For a column that it has not.
    pub fn column(&self, column: usize) -> &Direction {
        &self.columns[column]
    }

    /// One column with all its entries.
    ///
    /// # Panics
    /// For a column that it has not.
    pub fn dense(&self, column: usize) -> Vec<f64> {
        let mut dense = vec![0.0; self.rows];
        let own = &self.columns[column];
        for (into, entry) in dense[own.first().min(self.rows)..]
            .iter_mut()
            .zip(own.values())
        {
            *into = *entry;
        }
        dense
    }

    /// The matrix times a vector with an entry for each column.
    ///
    /// # Errors
    /// [`LinalgError::Shape`] if the length does not fit, [`LinalgError::NotFinite`] for a product that is not a finite
    /// number.
    pub fn times(&self, vector: &[f64]) -> Result<Vec<f64>, LinalgError> {
        check_length("vector of a product", self.columns.len(), vector.len())?;
        let mut product = vec![0.0; self.rows];
        for (column, factor) in self.columns.iter().zip(vector) {
            let into = &mut product[column.first().min(self.rows)..];
            for (sum, entry) in into.iter_mut().zip(column.values()) {
                *sum += entry * factor;
            }
        }
        match product.iter().position(|entry| !entry.is_finite()) {
            None => Ok(product),
            Some(row) => Err(LinalgError::NotFinite {
                row,
                column: self.columns.len(),
                value: product[row],
            }),
        }
    }

    /// Refuses a matrix without rows or columns, and entries that are not finite.
    pub(crate) fn check(&self) -> Result<(), LinalgError> {
        if self.rows == 0 || self.columns.is_empty() {
            return Err(LinalgError::Empty {
                rows: self.rows,
                columns: self.columns.len(),
            });
        }
        for (column, own) in self.columns.iter().enumerate() {
            let bad = own.values().iter().position(|entry| !entry.is_finite());
            if let Some(place) = bad {
                return Err(LinalgError::NotFinite {
                    row: own.first() + place,
                    column,
                    value: own.values()[place],
                });
            }
        }
        Ok(())
    }
}

impl From<&crate::Matrix> for SparseColumns {
    fn from(matrix: &crate::Matrix) -> Self {
        let columns = (0..matrix.columns()).map(|k| Direction::new(matrix.column(k).to_vec()));
        Self::new(matrix.rows(), columns.collect())
    }
}
