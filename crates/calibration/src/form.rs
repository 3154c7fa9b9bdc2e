//! The form of a problem in which it is solved fastest, with the answers that a fit asks of it.

use std::rc::Rc;

use haptical_batch::{DistanceProblem, ReducedDistance, Threads};
use haptical_identification::{
    Form, IdentificationError, Matrix, Problem, Reduction, evaluate_jacobian,
};

use crate::distances::Distances;
use crate::outputs::Outputs;
use crate::{DeviceProblem, MergedProblem, ReducedProblem};

/// From this number of residuals on, each channel is reduced to a triangle before the search: the
/// answer is the same, and the time less (README.md has the measurement).
const REDUCED_FROM: usize = 250;

/// A problem that may have a form in lanes.
pub(crate) struct Prepared<'p> {
    pub(crate) problem: &'p DeviceProblem<'p>,
    pub(crate) reduced: Rc<ReducedProblem<'p>>,
    merged: MergedProblem<'p>,
    distances: Option<Distances>,
    outputs: Option<Outputs>,
}

impl<'p> Prepared<'p> {
    pub(crate) fn new(problem: &'p DeviceProblem<'p>) -> Self {
        let distances = problem.distances();
        let outputs = if distances.is_none() {
            problem.transmission_outputs()
        } else {
            None
        };
        let reduced = Rc::new(ReducedProblem::new(problem));
        Self {
            problem,
            merged: MergedProblem::of(Rc::clone(&reduced)),
            reduced,
            distances,
            outputs,
        }
    }

    /// The distances of a chain, reduced in lanes.
    pub(crate) fn lanes(&self) -> Option<ReducedDistance<'_>> {
        let Distances { model, poses } = self.distances.as_ref()?;
        ReducedDistance::new(model, poses, Threads::Several).ok()
    }

    /// What is searched; `lanes` are those of [`Prepared::lanes`].
    pub(crate) fn searched<'s>(
        &'s self,
        lanes: Option<&'s ReducedDistance<'_>>,
    ) -> &'s dyn Problem {
        if let Some(lanes) = lanes {
            lanes
        } else if let Some(outputs) = &self.outputs {
            outputs
        } else if self.problem.residual_count() < REDUCED_FROM {
            self.problem
        } else if self.reduced.lanes().is_some() {
            &self.merged
        } else {
            &*self.reduced
        }
    }

    /// Whether some form is one in lanes.
    pub(crate) fn is_in_lanes(&self) -> bool {
        self.distances.is_some() || self.outputs.is_some()
    }

    /// Weighted residuals, row by row.
    pub(crate) fn residuals(&self, values: &[f64]) -> Result<Vec<f64>, IdentificationError> {
        let mut residuals = vec![0.0; self.problem.residual_count()];
        if let Some(Distances { model, poses }) = &self.distances
            && let Ok(rows) = DistanceProblem::new(model, poses)
        {
            rows.evaluate(values, &mut residuals, None)?;
        } else if let Some(outputs) = &self.outputs {
            outputs.residuals(values, &mut residuals)?;
        } else if self.problem.residual_count() >= REDUCED_FROM {
            self.merged.residuals(values, &mut residuals)?;
        } else {
            self.problem.evaluate(values, &mut residuals, None)?;
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
    let (jacobian, residuals) = evaluate_jacobian(problem, values, &all)?;
    if problem.form() == Form::Rows {
        return Ok(Reduction::new(&jacobian, &residuals)?);
    }
    let count = all.len();
    let triangle = Matrix::from_fn(count, count, |row, column| jacobian[(row, column)]);
    let rest_square = residuals[count..].iter().map(|rest| rest * rest).sum();
    let (projected, rows) = (&residuals[..count], residuals.len());
    Ok(Reduction::from_triangle(
        &triangle,
        projected,
        rest_square,
        rows,
    )?)
}
