//! A problem in parameters divided by their size, so that one step of a difference suits all.

use haptical_identification::{IdentificationError, Matrix, Problem};

/// The problem around a point, whose entries are the sizes.
pub(crate) struct Relative<'a, P> {
    problem: &'a P,
    sizes: Vec<f64>,
}

impl<'a, P: Problem> Relative<'a, P> {
    pub(crate) fn new(problem: &'a P, point: &[f64]) -> Self {
        let sizes = point.to_vec();
        Self { problem, sizes }
    }
}

impl<P: Problem> Problem for Relative<'_, P> {
    fn parameter_count(&self) -> usize {
        self.problem.parameter_count()
    }

    fn residual_count(&self) -> usize {
        self.problem.residual_count()
    }

    fn evaluate(
        &self,
        parameters: &[f64],
        residuals: &mut [f64],
        jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        let scaled: Vec<f64> = parameters
            .iter()
            .zip(&self.sizes)
            .map(|(parameter, size)| parameter * size)
            .collect();
        match jacobian {
            None => self.problem.evaluate(&scaled, residuals, None),
            Some((free, matrix)) => {
                self.problem
                    .evaluate(&scaled, residuals, Some((free, &mut *matrix)))?;
                for (column, &parameter) in free.iter().enumerate() {
                    for entry in matrix.column_mut(column) {
                        *entry *= self.sizes[parameter];
                    }
                }
                Ok(())
            }
        }
    }
}
