//! The least-squares problem: weighted residuals and their analytic derivatives.

use haptical_linalg::{LinalgError, Matrix, Triangle};

use crate::IdentificationError;

/// A nonlinear least-squares problem: minimise S(p) = sum r_i(p)^2 (Baser & Konukseven eq. (7)).
///
/// Residuals are divided by their standard deviations, so that a good fit has S near the number of
/// residuals less the number of parameters.
pub trait Problem {
    /// Number of parameters, free or not.
    fn parameter_count(&self) -> usize;

    /// Number of residuals.
    fn residual_count(&self) -> usize;

    /// The same problem as one that is reduced to a triangle, where it is: then a search takes cost and derivatives in
    /// one pass, and its steps from the triangle as it is.
    fn as_triangle(&self) -> Option<&dyn TriangleProblem> {
        None
    }

    /// Writes the residuals and, where asked, d residual_i / d parameter_j into the columns `free`
    /// of the parameter vector: column k of `jacobian` belongs to parameter `free[k]`.
    ///
    /// # Errors
    /// [`IdentificationError::Evaluation`] where the model has no value.
    fn evaluate(
        &self,
        parameters: &[f64],
        residuals: &mut [f64],
        jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError>;
}

/// A problem whose residuals and derivatives are reduced to a [`Triangle`] by orthogonal transformations: cost, steps,
/// rank and covariance are those of all rows.
///
/// Each is a [`Problem`] of one row more than it has parameters: the rows of the triangle, then the root of the rest.
pub trait TriangleProblem {
    /// Number of parameters, free or not.
    fn columns(&self) -> usize;

    /// Number of residuals that were reduced to the triangle.
    fn rows(&self) -> usize;

    /// Reduces the derivatives with respect to `free`, column k for parameter `free[k]`, and the residuals. Without free
    /// parameters the triangle holds the cost alone.
    ///
    /// # Errors
    /// As for [`Problem::evaluate`].
    fn reduce_into(
        &self,
        parameters: &[f64],
        free: &[usize],
        into: &mut Triangle,
    ) -> Result<(), IdentificationError>;
}

impl<P: TriangleProblem> Problem for P {
    fn parameter_count(&self) -> usize {
        self.columns()
    }

    fn residual_count(&self) -> usize {
        self.columns() + 1
    }

    fn as_triangle(&self) -> Option<&dyn TriangleProblem> {
        Some(self)
    }

    fn evaluate(
        &self,
        parameters: &[f64],
        residuals: &mut [f64],
        jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        let (free, matrix) = match jacobian {
            Some((free, matrix)) => (free, Some(matrix)),
            None => (&[][..], None),
        };
        let mut triangle = Triangle::new(free.len());
        self.reduce_into(parameters, free, &mut triangle)?;
        triangle.write_into(residuals, matrix);
        Ok(())
    }
}

/// The derivative matrix (residuals x `free`) and the residuals at one point.
///
/// # Errors
/// Whatever the problem says, [`IdentificationError::Shape`], and
/// [`IdentificationError::NotFinite`] for an entry that is not finite.
pub fn evaluate_jacobian<P: Problem + ?Sized>(
    problem: &P,
    parameters: &[f64],
    free: &[usize],
) -> Result<(Matrix, Vec<f64>), IdentificationError> {
    check_free(problem, parameters, free)?;
    let mut residuals = vec![0.0; problem.residual_count()];
    let mut jacobian = Matrix::zeros(problem.residual_count(), free.len());
    problem.evaluate(parameters, &mut residuals, Some((free, &mut jacobian)))?;
    let columns = (0..free.len()).map(|column| jacobian.column(column));
    for (column, values) in columns.chain([residuals.as_slice()]).enumerate() {
        if let Some(row) = values.iter().position(|value| !value.is_finite()) {
            let value = values[row];
            let error = IdentificationError::NotFinite { row, column, value };
            return Err(by_parameter(error, problem, free));
        }
    }
    Ok((jacobian, residuals))
}

/// Turns a column among the free parameters into a parameter's index.
pub(crate) fn by_parameter<P: Problem + ?Sized>(
    error: IdentificationError,
    problem: &P,
    free: &[usize],
) -> IdentificationError {
    match error {
        IdentificationError::NotFinite { row, column, value } => IdentificationError::NotFinite {
            row,
            column: free
                .get(column)
                .copied()
                .unwrap_or(problem.parameter_count()),
            value,
        },
        other => other,
    }
}

pub(crate) fn check_free<P: Problem + ?Sized>(
    problem: &P,
    parameters: &[f64],
    free: &[usize],
) -> Result<(), IdentificationError> {
    let expected = problem.parameter_count();
    if parameters.len() != expected {
        return Err(IdentificationError::Shape {
            what: "parameters",
            expected,
            found: parameters.len(),
        });
    }
    if let Some(column) = parameters.iter().position(|value| !value.is_finite()) {
        return Err(IdentificationError::NotFinite {
            row: 0,
            column,
            value: parameters[column],
        });
    }
    if free.is_empty() {
        return Err(IdentificationError::NothingFree);
    }
    if let Some(&index) = free.iter().find(|&&index| index >= expected) {
        return Err(IdentificationError::Shape {
            what: "free parameter index",
            expected,
            found: index,
        });
    }
    let mut seen = vec![false; expected];
    for &column in free {
        if std::mem::replace(&mut seen[column], true) {
            let columns = expected;
            return Err(LinalgError::Column { column, columns }.into());
        }
    }
    Ok(())
}

pub(crate) fn sum_of_squares(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}
