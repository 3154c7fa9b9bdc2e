//! The best dense path of a joint problem: all rows with all columns, in one blocked QR.

use haptical_batch::Triangle;
use haptical_calibration::MergedProblem;
use haptical_identification::{Form, IdentificationError, Matrix, Problem};

/// The rows of a joint problem as a dense matrix, folded by the same blocked Householder reflections in lanes.
///
/// Rows and derivatives are worked out as ours does, tile by tile, so that only the use of the zeros differs: an
/// external encoder's rows are filled up with the zeros of the parameters that it does not see.
pub(crate) struct Dense<'p>(pub(crate) &'p MergedProblem<'p>);

impl Problem for Dense<'_> {
    fn parameter_count(&self) -> usize {
        self.0.parameter_count()
    }

    fn residual_count(&self) -> usize {
        self.0.residual_count()
    }

    fn form(&self) -> Form {
        Form::Triangle
    }

    fn evaluate(
        &self,
        parameters: &[f64],
        residuals: &mut [f64],
        jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        let free = jacobian.as_ref().map_or(&[][..], |(free, _)| free);
        let count = free.len();
        let mut triangle = Triangle::new(count);
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
            let folded = triangle.fold_rows(&columns, rows.residuals);
            refused = refused.take().or(folded.err());
        })?;
        if let Some(error) = refused {
            return Err(error.into());
        }
        triangle.write_into(residuals, jacobian.map(|(_, matrix)| matrix));
        Ok(())
    }
}
