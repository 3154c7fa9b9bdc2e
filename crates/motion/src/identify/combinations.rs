//! Which combinations of the numbers a motion fixes: base parameters.
//!
//! Columns are offered in an order of preference to the guarded QR of `haptical-linalg` (Khalil and Dombre 2002, section 10.2.2;
//! Gautier 1991): a column that depends on those before it adds its number to theirs.

use std::rc::Rc;

use haptical_linalg::{OrderedRank, RANK_TOLERANCE, Reduction, Triangle};
use nalgebra::DMatrix;

use crate::MotionError;
use crate::fit::column::Column;
use crate::identify::numbers::{Number, order};

/// What the rows of a problem fix.
#[derive(Debug, Clone)]
pub(crate) struct Combinations {
    pub(crate) rank: OrderedRank,
    /// Base parameters as combinations of the numbers: one row each.
    pub(crate) map: DMatrix<f64>,
    reduction: Reduction,
}

impl Combinations {
    /// Of whitened columns and what they are to explain.
    ///
    /// # Errors
    /// [`MotionError::Fit`] for numbers that are not finite.
    pub(crate) fn new(
        numbers: &[Number],
        columns: &[Rc<Column>],
        target: &[f64],
        rows: usize,
    ) -> Result<Self, MotionError> {
        let triangle = folded(columns, target, rows)?;
        let reduction = triangle.reduction(target.len())?;
        let rank = reduction.ordered_rank(&order(numbers), RANK_TOLERANCE)?;
        let mut map = DMatrix::zeros(rank.independent.len(), numbers.len());
        let place = |column: usize| rank.independent.iter().position(|own| *own == column);
        for (row, column) in rank.independent.iter().enumerate() {
            map[(row, *column)] = 1.0;
        }
        for own in &rank.dependent {
            for (kept, coefficient) in &own.combination {
                if let Some(row) = place(*kept) {
                    map[(row, own.column)] = *coefficient;
                }
            }
        }
        Ok(Self {
            rank,
            map,
            reduction,
        })
    }

    /// Columns of the base parameters.
    pub(crate) fn kept(&self) -> &[usize] {
        &self.rank.independent
    }

    /// Numbers with the values of the base parameters; those that depend on others are 0.
    pub(crate) fn of_numbers(&self, values: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.map.ncols()];
        for (value, column) in values.iter().zip(self.kept()) {
            all[*column] = *value;
        }
        all
    }

    /// The normal equations' root: rows R and right side q with `|R b - q|^2` the squares of the rows up to a constant.
    pub(crate) fn root(&self) -> Result<(DMatrix<f64>, Vec<f64>), MotionError> {
        let kept = self.kept();
        let norms: Vec<f64> = kept
            .iter()
            .map(|column| self.reduction.column_norms()[*column])
            .collect();
        let factor = self.reduction.scaled_factor(kept, &norms)?;
        let root = DMatrix::from_fn(factor.rows(), kept.len(), |row, column| {
            factor.column(column)[row]
        });
        Ok((root, self.reduction.projected().to_vec()))
    }
}

/// Columns and a target in a triangle.
pub(crate) fn folded(
    columns: &[Rc<Column>],
    target: &[f64],
    rows: usize,
) -> Result<Triangle, MotionError> {
    let mut triangle = Triangle::new(columns.len());
    let zeros = vec![0.0; rows];
    // channel by channel: a column of one channel alone is zero in the others
    for first in (0..target.len()).step_by(rows) {
        let own: Vec<&[f64]> = columns
            .iter()
            .map(|column| {
                let (start, values) = column.parts();
                match start <= first && first + rows <= start + values.len() {
                    true => &values[first - start..][..rows],
                    false => zeros.as_slice(),
                }
            })
            .collect();
        triangle.fold_rows(&own, &target[first..first + rows])?;
    }
    Ok(triangle)
}
