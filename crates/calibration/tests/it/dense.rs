//! The best dense path of a joint problem: all rows with all columns, in one blocked QR.

use haptical_calibration::ReducedProblem;
use haptical_identification::{IdentificationError, Triangle, TriangleProblem};

/// The rows of a joint problem as a dense matrix, folded by the same blocked Householder reflections in lanes.
///
/// Rows and derivatives are worked out as ours does, tile by tile, so that only the use of the zeros differs: an
/// external encoder's rows are filled up with the zeros of the parameters that it does not see.
pub(crate) struct Dense<'p>(pub(crate) &'p ReducedProblem<'p>);

impl TriangleProblem for Dense<'_> {
    fn columns(&self) -> usize {
        self.0.columns()
    }

    fn rows(&self) -> usize {
        self.0.rows()
    }

    fn reduce_into(
        &self,
        parameters: &[f64],
        free: &[usize],
        into: &mut Triangle,
    ) -> Result<(), IdentificationError> {
        let count = free.len();
        *into = Triangle::new(count);
        let mut zeros = Vec::new();
        let mut refused = None;
        self.0.visit(parameters, free, |rows| {
            if zeros.len() < rows.residuals.len() {
                zeros.resize(rows.residuals.len(), 0.0);
            }
            let mut columns = vec![&zeros[..rows.residuals.len()]; count];
            for (&column, derivatives) in rows.columns.iter().zip(rows.derivatives) {
                columns[column] = derivatives;
            }
            let folded = into.fold_rows(&columns, rows.residuals);
            refused = refused.take().or(folded.err());
        })?;
        refused.map_or(Ok(()), |error| Err(error.into()))
    }
}
