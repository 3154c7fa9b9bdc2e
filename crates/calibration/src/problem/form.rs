//! The form of a problem in which it is solved fastest, with the answers that a fit asks of it.

use haptical_identification::{
    IdentificationError, Matrix, Problem, Reduction, Triangle, evaluate_jacobian,
};

use crate::problem::gauge::GaugedProblem;
use crate::{CalibrationError, Channel, DeviceProblem, ReducedProblem};

/// From this number of residuals on, each channel is reduced to a triangle before the search: the
/// answer is the same, and the time less (README.md has the measurement).
const REDUCED_FROM: usize = 250;

/// A problem that may have a form in lanes.
pub(crate) struct Prepared<'p> {
    pub(crate) problem: &'p DeviceProblem<'p>,
    reduced: ReducedProblem<'p>,
    gauged: GaugedProblem<'p>,
}

impl<'p> Prepared<'p> {
    pub(crate) fn new(problem: &'p DeviceProblem<'p>) -> Result<Self, CalibrationError> {
        let gauged = GaugedProblem::new(problem)?;
        Ok(Self {
            problem,
            reduced: ReducedProblem::with_gauge(problem, gauged.gauge()),
            gauged,
        })
    }

    /// The form that is searched.
    pub(crate) fn searched(&self) -> &dyn Problem {
        match self.is_reduced() {
            true => &self.reduced,
            false => self.row_by_row(),
        }
    }

    /// The form with a row for every residual.
    pub(crate) fn row_by_row(&self) -> &dyn Problem {
        &self.gauged
    }

    fn is_reduced(&self) -> bool {
        self.problem.residual_count() >= REDUCED_FROM || self.is_in_lanes()
    }

    /// Whether it is one external encoder, or one cable at joint angles that stay, in lanes: that is faster at any
    /// number of rows.
    pub(crate) fn is_in_lanes(&self) -> bool {
        let is_one = matches!(self.problem.blocks.as_slice(), [block] if match block.channel {
            Channel::Output { .. } => true,
            Channel::Cable { .. } => self.problem.outputs.is_some(),
            _ => false,
        });
        is_one && self.reduced.lanes().is_some()
    }

    /// Derivatives of each channel at `values`, in rows that stand for its own.
    pub(crate) fn by_channel(
        &self,
        values: &[f64],
        free: &[usize],
    ) -> Result<Vec<(Channel, Matrix)>, IdentificationError> {
        self.reduced.by_channel(values, free)
    }

    /// Weighted residuals, row by row.
    pub(crate) fn residuals(&self, values: &[f64]) -> Result<Vec<f64>, IdentificationError> {
        let mut residuals = vec![0.0; self.problem.residual_count()];
        match self.is_reduced() && self.gauged.gauge().is_none() {
            true => self.reduced.residuals(values, &mut residuals)?,
            false => self.gauged.evaluate(values, &mut residuals, None)?,
        }
        Ok(residuals)
    }
}

/// The linearised problem over all parameters, reduced.
pub(crate) fn reduce(
    problem: &dyn Problem,
    values: &[f64],
) -> Result<Reduction, IdentificationError> {
    let all: Vec<usize> = (0..values.len()).collect();
    if let Some(triangle) = problem.as_triangle() {
        let mut reduced = Triangle::new(all.len());
        triangle.reduce_into(values, &all, &mut reduced)?;
        return Ok(reduced.reduction(problem.residual_count())?);
    }
    let (jacobian, residuals) = evaluate_jacobian(problem, values, &all)?;
    Ok(Reduction::new(&jacobian, &residuals)?)
}
