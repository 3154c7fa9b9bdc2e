//! Rows of one channel, gathered and reduced in portions.

use haptical_identification::{IdentificationError, Matrix, Triangle};
use haptical_model::ModelError;

/// Rows that are gathered before they are reduced: a tile of the triangle.
const CHUNK_ROWS: usize = 256;

/// `[J r]` of one channel, reduced whenever enough rows have been gathered.
#[derive(Debug)]
pub(crate) struct GatheredRows {
    /// Position within the free parameters, and parameter, of each column.
    columns: Vec<(usize, usize)>,
    /// Number of parameters: names the residual in errors.
    parameters: usize,
    triangle: Triangle,
    /// Rows gathered since; the last column is the residual.
    rows: Matrix,
    filled: usize,
    failure: Option<IdentificationError>,
}

impl GatheredRows {
    pub(crate) fn new(columns: Vec<(usize, usize)>, parameters: usize) -> Self {
        Self {
            rows: Matrix::zeros(CHUNK_ROWS, columns.len() + 1),
            triangle: Triangle::new(columns.len()),
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

    /// Adds the rows of one reading; a failure of the arithmetic is reported by [`GatheredRows::finish`].
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

    /// Folds the gathered rows into the triangle.
    fn reduce(&mut self) {
        let columns: Vec<&[f64]> = (0..self.columns.len())
            .map(|column| &self.rows.column(column)[..self.filled])
            .collect();
        let residuals = &self.rows.column(self.columns.len())[..self.filled];
        if let Err(error) = self.triangle.fold_rows(&columns, residuals) {
            self.failure.get_or_insert_with(|| error.into());
        }
        self.filled = 0;
    }

    /// The triangle of all rows.
    pub(crate) fn finish(mut self) -> Result<Triangle, IdentificationError> {
        self.reduce();
        match self.failure {
            Some(failure) => Err(failure),
            None => Ok(self.triangle),
        }
    }
}
