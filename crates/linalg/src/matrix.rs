//! A dense matrix of `f64`, stored column by column.

use crate::LinalgError;
use crate::error::check_length;
use crate::lanes::norm;

/// Dense matrix, column-major.
///
/// ```
/// use haptical_linalg::Matrix;
/// let matrix = Matrix::from_fn(2, 3, |row, column| (row * 10 + column) as f64);
/// assert_eq!(matrix.column(1), &[1.0, 11.0]);
/// assert_eq!(matrix[(1, 2)], 12.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    rows: usize,
    columns: usize,
    data: Vec<f64>,
}

impl Matrix {
    /// A matrix of zeros.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self {
            rows,
            columns,
            data: vec![0.0; rows * columns],
        }
    }

    /// A matrix whose entry at (row, column) is `entry(row, column)`.
    pub fn from_fn(
        rows: usize,
        columns: usize,
        mut entry: impl FnMut(usize, usize) -> f64,
    ) -> Self {
        let mut matrix = Self::zeros(rows, columns);
        for column in 0..columns {
            for row in 0..rows {
                matrix[(row, column)] = entry(row, column);
            }
        }
        matrix
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// One column.
    pub fn column(&self, column: usize) -> &[f64] {
        &self.data[column * self.rows..(column + 1) * self.rows]
    }

    /// One column, to be written.
    pub fn column_mut(&mut self, column: usize) -> &mut [f64] {
        &mut self.data[column * self.rows..(column + 1) * self.rows]
    }

    /// The matrix times a vector of [`Matrix::columns`] entries.
    ///
    /// # Errors
    /// [`LinalgError::Shape`] if the length does not fit, [`LinalgError::NotFinite`] for a product
    /// that is not a finite number.
    pub fn times(&self, vector: &[f64]) -> Result<Vec<f64>, LinalgError> {
        check_length("vector of a product", self.columns, vector.len())?;
        let mut product = vec![0.0; self.rows];
        for (column, factor) in vector.iter().enumerate() {
            for (sum, entry) in product.iter_mut().zip(self.column(column)) {
                *sum += entry * factor;
            }
        }
        match product.iter().position(|entry| !entry.is_finite()) {
            None => Ok(product),
            Some(row) => Err(LinalgError::NotFinite {
                row,
                column: self.columns,
                value: product[row],
            }),
        }
    }

    /// Writes the matrix times another one over `into`, which takes its shape.
    ///
    /// ```
    /// use haptical_linalg::Matrix;
    /// let matrix = Matrix::from_fn(3, 2, |row, column| (row + column) as f64);
    /// let mut product = Matrix::zeros(0, 0);
    /// matrix.product_into(&Matrix::from_fn(2, 1, |row, _| [2.0, -1.0][row]), &mut product)?;
    /// assert_eq!(product.column(0), [-1.0, 0.0, 1.0]);
    /// # Ok::<(), haptical_linalg::LinalgError>(())
    /// ```
    ///
    /// # Errors
    /// [`LinalgError::Shape`] where the other one has not as many rows as this one has columns.
    pub fn product_into(&self, right: &Self, into: &mut Self) -> Result<(), LinalgError> {
        check_length("right side of a product", self.columns, right.rows)?;
        (into.rows, into.columns) = (self.rows, right.columns);
        into.data.resize(self.rows * right.columns, 0.0);
        faer::linalg::matmul::matmul(
            faer::MatMut::from_column_major_slice_mut(&mut into.data, into.rows, into.columns),
            faer::Accum::Replace,
            self.as_faer(),
            right.as_faer(),
            1.0,
            faer::Par::Seq,
        );
        Ok(())
    }

    /// Refuses empty matrices and entries that are not finite.
    pub(crate) fn check(&self) -> Result<(), LinalgError> {
        if self.rows == 0 || self.columns == 0 {
            return Err(LinalgError::Empty {
                rows: self.rows,
                columns: self.columns,
            });
        }
        match self.data.iter().position(|entry| !entry.is_finite()) {
            None => Ok(()),
            Some(index) => Err(LinalgError::NotFinite {
                row: index % self.rows,
                column: index / self.rows,
                value: self.data[index],
            }),
        }
    }

    /// The matrix with every column that is not zero divided by its norm, and the norms.
    pub(crate) fn into_unit_columns(mut self) -> Result<(Self, Vec<f64>), LinalgError> {
        let mut norms = Vec::with_capacity(self.columns);
        for column in 0..self.columns {
            let size = norm(self.column(column));
            if !size.is_finite() {
                return Err(LinalgError::Overflow {
                    what: "a column norm",
                });
            }
            if size > 0.0 {
                let entries = self.column_mut(column).iter_mut();
                entries.for_each(|entry| *entry /= size);
            }
            norms.push(size);
        }
        Ok((self, norms))
    }

    /// Whether all entries are zero.
    pub(crate) fn is_zero(&self) -> bool {
        self.data.iter().all(|entry| *entry == 0.0)
    }

    pub(crate) fn as_faer(&self) -> faer::MatRef<'_, f64> {
        faer::MatRef::from_column_major_slice(&self.data, self.rows, self.columns)
    }
}

impl std::ops::Index<(usize, usize)> for Matrix {
    type Output = f64;

    fn index(&self, (row, column): (usize, usize)) -> &f64 {
        // By way of the column: a row out of range must not reach into the next column.
        &self.column(column)[row]
    }
}

impl std::ops::IndexMut<(usize, usize)> for Matrix {
    fn index_mut(&mut self, (row, column): (usize, usize)) -> &mut f64 {
        &mut self.column_mut(column)[row]
    }
}
