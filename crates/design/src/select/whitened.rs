//! Rows of the identifiable parameters in units in which all candidates together have the unit information.

use haptical_identification::{Identifiability, Matrix};
use nalgebra::{DMatrix, DVector};

use crate::{DesignError, Information};

/// Rows x = R^-T D^-1 a of the design, where D holds the norms of the columns of all candidates' rows a and R
/// is the factor of the scaled columns: the information of all candidates is the identity.
///
/// No unit of a parameter is left in them, and sums over some candidates are well conditioned where the raw
/// ones are not. The determinant of any selection differs from the raw one by one constant factor; a quadratic
/// criterion is brought to these units with its own rows ([`Whitened::task`]).
#[derive(Debug, Clone)]
pub(crate) struct Whitened {
    /// Columns are rows of the design, pose by pose; those that are always there come first.
    pub(crate) rows: DMatrix<f64>,
    /// The same, rows of the design as rows: what products with all of them are made of.
    across: Matrix,
    /// First column of each pose, and the end.
    pub(crate) first: Vec<usize>,
    /// The parameters that are free, by their index.
    pub(crate) columns: Vec<usize>,
    norms: Vec<f64>,
    /// R transposed.
    lower: DMatrix<f64>,
}

impl Whitened {
    pub(crate) fn new(
        information: &Information,
        judged: &Identifiability,
    ) -> Result<Self, DesignError> {
        let columns = judged.independent.clone();
        if columns.is_empty() {
            let reason = (0..judged.names.len()).find_map(|index| judged.reason(index));
            return Err(DesignError::NothingIdentifiable {
                rig: information.equipped.rig.name.clone(),
                reason: reason.unwrap_or_else(|| "it has no parameter".to_owned()),
            });
        }
        let reduction = information.reduce(0..information.poses(), 1.0)?;
        let norms: Vec<f64> = columns
            .iter()
            .map(|&column| reduction.column_norms()[column])
            .collect();
        let factor = reduction.scaled_factor(&columns, &vec![1.0; columns.len()])?;
        let factor = DMatrix::from_fn(factor.rows(), factor.columns(), |i, j| factor[(i, j)]);
        let lower = factor.qr().r().transpose();
        let mut whitened = Self {
            rows: DMatrix::zeros(0, 0),
            across: Matrix::zeros(0, 0),
            first: Vec::new(),
            columns,
            norms,
            lower,
        };
        let poses = std::iter::once(None).chain((0..information.poses()).map(Some));
        let mut raw: Vec<f64> = Vec::new();
        let mut count = 0;
        for pose in poses {
            for row in information.rows_of(pose) {
                raw.extend(whitened.columns.iter().map(|&column| row[column]));
                count += 1;
            }
            whitened.first.push(count);
        }
        whitened.rows = whitened.bring(DMatrix::from_vec(whitened.columns.len(), count, raw));
        whitened.across = across(&whitened.rows);
        Ok(whitened)
    }

    /// Brings raw rows (as columns of a matrix, one entry for each free parameter) to these units.
    fn bring(&self, mut raw: DMatrix<f64>) -> DMatrix<f64> {
        for mut column in raw.column_iter_mut() {
            let scaled = column.iter_mut().zip(&self.norms);
            scaled.for_each(|(value, norm)| *value /= norm);
        }
        // the diagonal is that of independent columns, never zero
        self.lower.solve_lower_triangular_mut(&mut raw);
        raw
    }

    /// The weight W = sum of t t^T of a quadratic criterion trace(W C), from rows t over all parameters.
    pub(crate) fn task(&self, rows: &[Vec<f64>]) -> DMatrix<f64> {
        let count = self.columns.len();
        let raw = DMatrix::from_fn(count, rows.len(), |index, row| {
            rows[row][self.columns[index]]
        });
        let brought = self.bring(raw);
        let mut weight = DMatrix::zeros(count, count);
        for column in brought.column_iter() {
            weight.ger(1.0, &DVector::from(column), &DVector::from(column), 1.0);
        }
        weight
    }

    /// Products of all rows with vectors, one vector's after the other's.
    pub(crate) fn times(&self, vectors: &DMatrix<f64>, into: &mut Matrix) {
        let (height, count) = vectors.shape();
        let vectors = Matrix::from_fn(height, count, |row, column| vectors[(row, column)]);
        // as many entries as there are parameters, whatever the change
        let made = self.across.product_into(&vectors, into);
        debug_assert!(made.is_ok(), "{made:?}");
    }

    /// Number of poses.
    pub(crate) fn poses(&self) -> usize {
        self.first.len() - 1
    }

    /// Readings of a pose.
    pub(crate) fn readings(&self, pose: usize) -> usize {
        self.first[pose + 1] - self.first[pose]
    }

    /// The rows of a pose, as columns.
    pub(crate) fn pose_rows(&self, pose: usize) -> nalgebra::DMatrixView<'_, f64> {
        self.rows.columns(self.first[pose], self.readings(pose))
    }

    /// ln of the determinant's factor between raw parameters in units of `sizes` and these:
    /// ln det(raw, scaled) = ln det(whitened) + this.
    pub(crate) fn log_det_shift(&self, sizes: &[f64]) -> f64 {
        let diagonal = (0..self.columns.len()).map(|index| self.lower[(index, index)].abs());
        let parts = diagonal.zip(&self.norms).zip(&self.columns);
        2.0 * parts
            .map(|((diagonal, norm), &column)| (diagonal * norm * sizes[column]).ln())
            .sum::<f64>()
    }
}

fn across(rows: &DMatrix<f64>) -> Matrix {
    Matrix::from_fn(rows.ncols(), rows.nrows(), |row, column| {
        rows[(column, row)]
    })
}

#[cfg(test)]
impl Whitened {
    /// Rows as they are.
    pub(crate) fn of_rows(rows: DMatrix<f64>, first: Vec<usize>) -> Self {
        let count = rows.nrows();
        Self {
            across: across(&rows),
            rows,
            first,
            columns: (0..count).collect(),
            norms: vec![1.0; count],
            lower: DMatrix::identity(count, count),
        }
    }
}
