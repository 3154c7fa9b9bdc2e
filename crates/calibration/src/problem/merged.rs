//! All channels' triangles folded into one: the form in which a joint problem is searched.

use std::rc::Rc;

use haptical_batch::Triangle;
use haptical_identification::{Form, IdentificationError, Matrix, Problem, evaluate_jacobian};

use crate::problem::reduced::ChannelFactor;
use crate::{Channel, DeviceProblem, ReducedProblem};

/// A [`ReducedProblem`] whose triangles, one for each channel, are folded into a single one: a pass gives cost
/// and triangle, so a search evaluates each trial once and takes its step from the triangle as it is.
///
/// With `[F_b q_b]` the triangle of channel b (its columns those that the channel can see), `[R q]` of this
/// problem is what orthogonal transformations make of all of them, one below the other:
/// `[R q]^T [R q] = sum_b [F_b q_b]^T [F_b q_b] = [J r]^T [J r]` (docs/equations.md, "Joint problem").
#[derive(Debug)]
pub struct MergedProblem<'p> {
    reduced: Rc<ReducedProblem<'p>>,
}

/// Some successive rows of one channel, as [`MergedProblem::visit`] hands them over.
#[derive(Debug, Clone, Copy)]
pub struct ChannelRows<'r> {
    /// Channel.
    pub channel: Channel,
    /// First residual of the problem (see [`DeviceProblem::layout`]).
    pub first: usize,
    /// Position within the free parameters of each column; the others' derivatives are zero.
    pub columns: &'r [usize],
    /// Derivatives of the weighted residuals, column by column.
    pub derivatives: &'r [&'r [f64]],
    /// Weighted residuals.
    pub residuals: &'r [f64],
}

impl<'p> MergedProblem<'p> {
    /// The merged form of a problem.
    pub fn new(problem: &'p DeviceProblem<'p>) -> Self {
        Self::of(Rc::new(ReducedProblem::new(problem)))
    }

    pub(crate) fn of(reduced: Rc<ReducedProblem<'p>>) -> Self {
        Self { reduced }
    }

    /// Hands all rows over, some at a time, each channel's in order; no derivative matrix is held where the
    /// problem has a form in lanes.
    ///
    /// # Errors
    /// As [`Problem::evaluate`] of the [`DeviceProblem`]; rows before the one that is refused may have been
    /// visited.
    pub fn visit(
        &self,
        parameters: &[f64],
        free: &[usize],
        mut visit: impl FnMut(&ChannelRows<'_>),
    ) -> Result<(), IdentificationError> {
        let problem = self.reduced.problem();
        let channels: Vec<Channel> = problem.channels().collect();
        if let Some(lanes) = self.reduced.lanes() {
            let visited = lanes.visit(problem, parameters, free, |rows| {
                let all = rows.of.iter().map(|&own| rows.derivatives[own]);
                let derivatives: Vec<&[f64]> = all.collect();
                visit(&ChannelRows {
                    channel: channels[rows.channel],
                    first: rows.first,
                    columns: rows.columns,
                    derivatives: &derivatives,
                    residuals: rows.residuals,
                });
            });
            if visited.is_some() {
                return Ok(());
            }
            // row by row it is told which one is refused
            let mut residuals = vec![0.0; problem.residual_count()];
            problem.evaluate(parameters, &mut residuals, None)?;
            return Err(IdentificationError::Evaluation {
                reason: "a number of the chain is beyond what the lanes work with".to_owned(),
            });
        }
        let (jacobian, residuals) = if free.is_empty() {
            let mut residuals = vec![0.0; problem.residual_count()];
            problem.evaluate(parameters, &mut residuals, None)?;
            (Matrix::zeros(residuals.len(), 0), residuals)
        } else {
            evaluate_jacobian(problem, parameters, free)?
        };
        let columns: Vec<usize> = (0..free.len()).collect();
        for (channel, (first, count)) in problem.layout() {
            let own = first..first + count;
            let slices: Vec<&[f64]> = columns
                .iter()
                .map(|&column| &jacobian.column(column)[own.clone()])
                .collect();
            visit(&ChannelRows {
                channel,
                first,
                columns: &columns,
                derivatives: &slices,
                residuals: &residuals[own],
            });
        }
        Ok(())
    }

    /// Weighted residuals, row by row.
    pub(crate) fn residuals(
        &self,
        parameters: &[f64],
        residuals: &mut [f64],
    ) -> Result<(), IdentificationError> {
        let problem = self.reduced.problem();
        let visited = self.reduced.lanes().and_then(|lanes| {
            lanes.visit(problem, parameters, &[], |rows| {
                residuals[rows.first..][..rows.residuals.len()].copy_from_slice(rows.residuals);
            })
        });
        match visited {
            Some(()) => Ok(()),
            None => problem.evaluate(parameters, residuals, None),
        }
    }
}

impl Problem for MergedProblem<'_> {
    fn parameter_count(&self) -> usize {
        self.reduced.parameter_count()
    }

    fn residual_count(&self) -> usize {
        self.parameter_count() + 1
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
        let (mut triangle, factors) = match self.reduced.triangles(parameters, free) {
            Some(mut channels) => {
                // a channel that sees all parameters has the total's columns: the others are folded into it
                let mut columns = channels.iter().map(|channel| channel.triangle.columns());
                let total = match columns.position(|count| count == free.len()) {
                    Some(widest) => channels.swap_remove(widest).triangle,
                    None => Triangle::new(free.len()),
                };
                let others = channels.into_iter().map(ChannelFactor::new);
                (total, others.collect())
            }
            None => (
                Triangle::new(free.len()),
                self.reduced.factors_by_row(parameters, free)?,
            ),
        };
        let factors: Vec<ChannelFactor> = factors;
        let most = factors.iter().map(|factor| factor.rows.rows()).max();
        let zeros = vec![0.0; most.unwrap_or(0)];
        for factor in &factors {
            let mut columns = vec![&zeros[..factor.rows.rows()]; free.len()];
            for (&own, &column) in factor.of.iter().zip(&factor.columns) {
                columns[column] = factor.rows.column(own);
            }
            triangle.fold_rows(&columns, factor.projected())?;
        }
        triangle.write_into(residuals, jacobian.map(|(_, matrix)| matrix));
        Ok(())
    }
}
