//! Rows of one channel, gathered and reduced in portions.

use haptical_identification::{IdentificationError, Matrix, Reduction};
use haptical_model::ModelError;

/// Rows that are gathered before they are reduced: with 58 columns they fill a quarter of a
/// megabyte, which stays in the second-level cache, and the triangle above them costs a tenth.
const CHUNK_ROWS: usize = 512;

/// `[J r]` of one channel, reduced whenever enough rows have been gathered.
#[derive(Debug)]
pub(crate) struct GatheredRows {
    /// Position within the free parameters, and parameter, of each column.
    columns: Vec<(usize, usize)>,
    /// Number of parameters: names the residual in errors.
    parameters: usize,
    /// Reduced rows first, then those gathered since; the last column is the residual.
    rows: Matrix,
    filled: usize,
    failure: Option<IdentificationError>,
}

impl GatheredRows {
    pub(crate) fn new(columns: Vec<(usize, usize)>, parameters: usize) -> Self {
        let width = columns.len() + 1;
        Self {
            rows: Matrix::zeros(CHUNK_ROWS.max(4 * width), width),
            columns,
            parameters,
            filled: 0,
            failure: None,
        }
    }

    /// Position within the free parameters of each column.
    pub(crate) fn positions(&self) -> impl Iterator<Item = usize> {
        self.columns.iter().map(|(position, _)| *position)
    }

    /// Adds the rows of one reading; a failure of the arithmetic is told by [`GatheredRows::finish`].
    pub(crate) fn append(
        &mut self,
        index: usize,
        residuals: &[f64],
        mut derivative: impl FnMut(usize) -> Result<[f64; 3], ModelError>,
    ) -> Result<(), ModelError> {
        if self.filled + residuals.len() > self.rows.rows() {
            self.reduce();
        }
        for position in 0..self.columns.len() {
            let (_, parameter) = self.columns[position];
            let values = derivative(parameter)?;
            self.write(index, position, parameter, &values[..residuals.len()]);
        }
        self.write(index, self.columns.len(), self.parameters, residuals);
        self.filled += residuals.len();
        Ok(())
    }

    fn write(&mut self, index: usize, position: usize, parameter: usize, values: &[f64]) {
        for (axis, &value) in values.iter().enumerate() {
            self.rows[(self.filled + axis, position)] = value;
            if !value.is_finite() && self.failure.is_none() {
                self.failure = Some(IdentificationError::NotFinite {
                    row: index + axis,
                    column: parameter,
                    value,
                });
            }
        }
    }

    fn reduce(&mut self) {
        let width = self.rows.columns();
        if self.filled <= width {
            return;
        }
        let gathered = Matrix::from_fn(self.filled, width, |row, column| self.rows[(row, column)]);
        let all: Vec<usize> = (0..width).collect();
        let reduced = Reduction::new(&gathered, &vec![0.0; self.filled])
            .and_then(|reduction| reduction.scaled_factor(&all, reduction.column_norms()));
        self.filled = match reduced {
            Ok(factor) => {
                for column in 0..width {
                    self.rows.column_mut(column)[..factor.rows()]
                        .copy_from_slice(factor.column(column));
                }
                factor.rows()
            }
            Err(error) => {
                self.failure.get_or_insert_with(|| error.into());
                0
            }
        };
    }

    /// At most one row more than there are parameter columns.
    pub(crate) fn finish(mut self) -> Result<Matrix, IdentificationError> {
        self.reduce();
        match self.failure {
            Some(failure) => Err(failure),
            None => Ok(Matrix::from_fn(
                self.filled,
                self.rows.columns(),
                |row, column| self.rows[(row, column)],
            )),
        }
    }
}
