//! The form of a problem in which it is solved fastest, with the answers that a fit asks of it.

use haptical_batch::{DistanceProblem, ReducedDistance, Threads};
use haptical_identification::{
    IdentificationError, Matrix, Problem, Reduction, Triangle, evaluate_jacobian,
};

use crate::problem::gauge::GaugedProblem;
use crate::problem::lanes::distances::Distances;
use crate::problem::lanes::outputs::Outputs;
use crate::{CalibrationError, Channel, DeviceProblem, ReducedProblem};

/// From this number of residuals on, each channel is reduced to a triangle before the search: the
/// answer is the same, and the time less (README.md has the measurement).
const REDUCED_FROM: usize = 250;

/// A problem that may have a form in lanes.
pub(crate) struct Prepared<'p> {
    pub(crate) problem: &'p DeviceProblem<'p>,
    reduced: ReducedProblem<'p>,
    distances: Option<Distances>,
    outputs: Option<Outputs>,
    gauged: GaugedProblem<'p>,
}

impl<'p> Prepared<'p> {
    pub(crate) fn new(problem: &'p DeviceProblem<'p>) -> Result<Self, CalibrationError> {
        let distances = distances_of(problem);
        let outputs = if distances.is_none() {
            outputs_of(problem)
        } else {
            None
        };
        Ok(Self {
            problem,
            reduced: ReducedProblem::new(problem),
            distances,
            outputs,
            gauged: GaugedProblem::new(problem)?,
        })
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
        if self.gauged.is_scaled() {
            &self.gauged
        } else if let Some(lanes) = lanes {
            lanes
        } else if let Some(outputs) = &self.outputs {
            outputs
        } else if self.problem.residual_count() < REDUCED_FROM {
            self.problem
        } else {
            &self.reduced
        }
    }

    /// Whether some form is one in lanes.
    pub(crate) fn is_in_lanes(&self) -> bool {
        self.distances.is_some() || self.outputs.is_some()
    }

    /// Derivatives of each channel at `values`, in rows that stand for its own.
    pub(crate) fn by_channel(
        &self,
        values: &[f64],
        free: &[usize],
    ) -> Result<Vec<(Channel, Matrix)>, IdentificationError> {
        if !self.gauged.is_scaled() {
            return self.reduced.by_channel(values, free);
        }
        let (jacobian, _) = evaluate_jacobian(&self.gauged, values, free)?;
        let blocks = self.problem.blocks.iter();
        let own = blocks.map(|block| {
            let rows = block.end() - block.first;
            let entry = |row: usize, column: usize| jacobian[(block.first + row, column)];
            (block.channel, Matrix::from_fn(rows, free.len(), entry))
        });
        Ok(own.collect())
    }

    /// Weighted residuals, row by row.
    pub(crate) fn residuals(&self, values: &[f64]) -> Result<Vec<f64>, IdentificationError> {
        let mut residuals = vec![0.0; self.problem.residual_count()];
        if self.gauged.is_scaled() {
            self.gauged.evaluate(values, &mut residuals, None)?;
        } else if let Some(Distances { model, poses }) = &self.distances
            && let Ok(rows) = DistanceProblem::new(model, poses)
        {
            rows.evaluate(values, &mut residuals, None)?;
        } else if let Some(outputs) = &self.outputs {
            outputs.residuals(values, &mut residuals)?;
        } else if self.problem.residual_count() >= REDUCED_FROM {
            self.reduced.residuals(values, &mut residuals)?;
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
    if let Some(triangle) = problem.as_triangle() {
        let mut reduced = Triangle::new(all.len());
        triangle.reduce_into(values, &all, &mut reduced)?;
        return Ok(reduced.reduction(problem.residual_count())?);
    }
    let (jacobian, residuals) = evaluate_jacobian(problem, values, &all)?;
    Ok(Reduction::new(&jacobian, &residuals)?)
}

/// The problem in lanes, if it is one of a chain's parameters and one distance.
fn distances_of(problem: &DeviceProblem<'_>) -> Option<Distances> {
    let [block] = problem.blocks.as_slice() else {
        return None;
    };
    Distances::new(
        problem.device,
        problem.recording,
        problem.parameters,
        block.channel,
        problem.outputs.as_deref()?,
        (&block.rows, &block.weights),
    )
}

/// The problem in lanes, if it is one of a transmission's parameters and its external encoder.
fn outputs_of(problem: &DeviceProblem<'_>) -> Option<Outputs> {
    let [block] = problem.blocks.as_slice() else {
        return None;
    };
    Outputs::new(
        problem.device,
        problem.recording,
        problem.parameters,
        block.channel,
        (&block.rows, &block.weights),
    )
}
