//! Checks a problem's analytic derivatives against central differences.

use haptical_linalg::Matrix;

use crate::problem::check_free;
use crate::{IdentificationError, Problem};

/// The entry where analytic and numeric derivative differ most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DerivativeMismatch {
    /// Residual.
    pub row: usize,
    /// Parameter.
    pub parameter: usize,
    /// Analytic value.
    pub analytic: f64,
    /// Central difference.
    pub numeric: f64,
    /// Difference relative to the largest analytic entry of that parameter's column.
    pub relative: f64,
}

/// Compares every analytic derivative with (r(p + h) - r(p - h)) / 2h, h = `step` per parameter.
///
/// A well-written derivative agrees to about `step`^2 plus 1e-16 / `step`, relative.
///
/// # Errors
/// Whatever the problem says, and [`IdentificationError::Shape`].
pub fn worst_derivative<P: Problem + ?Sized>(
    problem: &P,
    parameters: &[f64],
    step: f64,
) -> Result<DerivativeMismatch, IdentificationError> {
    let free: Vec<usize> = (0..problem.parameter_count()).collect();
    check_free(problem, parameters, &free)?;
    let rows = problem.residual_count();
    let mut jacobian = Matrix::zeros(rows, free.len());
    let (mut above, mut below) = (vec![0.0; rows], vec![0.0; rows]);
    problem.evaluate(parameters, &mut above, Some((&free, &mut jacobian)))?;
    let mut worst = DerivativeMismatch {
        row: 0,
        parameter: 0,
        analytic: 0.0,
        numeric: 0.0,
        relative: 0.0,
    };
    let mut moved = parameters.to_vec();
    for parameter in free {
        moved[parameter] = parameters[parameter] + step;
        problem.evaluate(&moved, &mut above, None)?;
        moved[parameter] = parameters[parameter] - step;
        problem.evaluate(&moved, &mut below, None)?;
        moved[parameter] = parameters[parameter];
        let column = jacobian.column(parameter);
        let largest = column
            .iter()
            .fold(f64::MIN_POSITIVE, |l, value| l.max(value.abs()));
        for row in 0..rows {
            let numeric = (above[row] - below[row]) / (2.0 * step);
            let relative = (numeric - column[row]).abs() / largest.max(numeric.abs());
            if relative > worst.relative {
                worst = DerivativeMismatch {
                    row,
                    parameter,
                    analytic: column[row],
                    numeric,
                    relative,
                };
            }
        }
    }
    Ok(worst)
}
