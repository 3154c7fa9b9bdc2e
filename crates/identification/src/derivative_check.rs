//! Checks a problem's analytic derivatives against central differences.

use crate::{IdentificationError, Problem, evaluate_jacobian};

/// The entry where analytic and numeric derivative differ most.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
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
/// Whatever the problem says, [`IdentificationError::Shape`], [`IdentificationError::Setting`] for a
/// step that is not above 0 and [`IdentificationError::NotFinite`] for a value or derivative that is
/// not finite.
pub fn worst_derivative<P: Problem + ?Sized>(
    problem: &P,
    parameters: &[f64],
    step: f64,
) -> Result<DerivativeMismatch, IdentificationError> {
    let is_allowed = step.is_finite() && step > 0.0;
    IdentificationError::unless(is_allowed, "step", step, "above 0")?;
    let free: Vec<usize> = (0..problem.parameter_count()).collect();
    let (jacobian, mut above) = evaluate_jacobian(problem, parameters, &free)?;
    let rows = above.len();
    let mut below = vec![0.0; rows];
    let mut worst = DerivativeMismatch::default();
    let mut moved = parameters.to_vec();
    for parameter in free {
        let (right, left) = (parameters[parameter] + step, parameters[parameter] - step);
        moved[parameter] = right;
        problem.evaluate(&moved, &mut above, None)?;
        moved[parameter] = left;
        problem.evaluate(&moved, &mut below, None)?;
        moved[parameter] = parameters[parameter];
        let column = jacobian.column(parameter);
        let largest = column
            .iter()
            .fold(f64::MIN_POSITIVE, |l, value| l.max(value.abs()));
        for row in 0..rows {
            // The distance that was moved in floating point, not the one that was meant.
            let numeric = (above[row] - below[row]) / (right - left);
            if !numeric.is_finite() {
                return Err(IdentificationError::NotFinite {
                    row,
                    column: parameter,
                    value: numeric,
                });
            }
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
