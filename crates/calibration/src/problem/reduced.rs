//! The same least-squares problem with few rows: each channel is reduced to a triangle on the way.

use std::cell::OnceCell;

use haptical_identification::{IdentificationError, Matrix, Problem};

use crate::problem::gathered::GatheredRows;
use crate::problem::lanes::all_rows::{ChannelTriangle, Lanes, as_rows};
use crate::problem::lanes::plan::seen_columns;
use crate::problem::sink::Sink;
use crate::{Channel, DeviceProblem};

/// A [`DeviceProblem`] whose derivative matrix is never held.
///
/// The derivative matrix of the joint problem is block diagonal in the external encoders' rows and
/// full in the distances' (docs/equations.md, "Joint problem"). For channel b, with J_b its
/// derivatives (only of the k_b parameters that it can see) and r_b its residuals, `[J_b r_b]` is
/// reduced in portions to a triangle `[F_b q_b]` of k_b + 1 rows with
///
/// ```text
/// [F_b q_b]^T [F_b q_b] = [J_b r_b]^T [J_b r_b]
/// ```
///
/// by orthogonal transformations, never by normal equations. The triangles, one below the other and
/// filled up with zero rows, are this problem's derivatives and residuals: its cost, its steps, its
/// rank and its covariance are those of the full problem, at sum (k_b + 1) rows instead of one for
/// each reading. Where no derivatives are asked for, the first residual is |r| and the others are 0.
///
/// Outputs of transmissions that equation (1) or a polynomial describes, and distances of a chain, are worked
/// out and reduced in lanes, in parallel; everything else row by row.
#[derive(Debug)]
pub struct ReducedProblem<'p> {
    problem: &'p DeviceProblem<'p>,
    /// Channel and number of rows, k_b + 1 for all parameters.
    blocks: Vec<(Channel, usize)>,
    /// Made when first asked for; none where the problem has no form in lanes.
    lanes: OnceCell<Option<Lanes>>,
}

/// `[F q]` of one channel.
pub(crate) struct ChannelFactor {
    /// Position within the free parameters of each column.
    pub(crate) columns: Vec<usize>,
    /// Which column of `rows` each is.
    pub(crate) of: Vec<usize>,
    /// As many rows as columns at most; the last column is q.
    pub(crate) rows: Matrix,
}

impl ChannelFactor {
    /// A triangle as rows.
    pub(crate) fn new(channel: ChannelTriangle) -> Self {
        Self {
            columns: channel.columns,
            of: channel.of,
            rows: as_rows(&channel.triangle),
        }
    }

    /// q.
    pub(crate) fn projected(&self) -> &[f64] {
        self.rows.column(self.rows.columns() - 1)
    }
}

impl<'p> ReducedProblem<'p> {
    /// The reduced form of a problem.
    pub fn new(problem: &'p DeviceProblem<'p>) -> Self {
        let blocks = problem
            .channels()
            .map(|channel| {
                let seen = problem.parameters().iter();
                let count = seen.filter(|&&parameter| channel.can_see(parameter));
                (channel, count.count() + 1)
            })
            .collect();
        Self {
            problem,
            blocks,
            lanes: OnceCell::new(),
        }
    }

    /// Channels with the rows of their triangles, in order.
    pub fn layout(&self) -> &[(Channel, usize)] {
        &self.blocks
    }

    pub(crate) fn problem(&self) -> &'p DeviceProblem<'p> {
        self.problem
    }

    pub(crate) fn lanes(&self) -> Option<&Lanes> {
        self.lanes.get_or_init(|| Lanes::new(self.problem)).as_ref()
    }

    /// Every channel's columns and triangle in lanes; none where there are no lanes or they refuse a number.
    pub(crate) fn triangles(
        &self,
        parameters: &[f64],
        free: &[usize],
    ) -> Option<Vec<ChannelTriangle>> {
        self.lanes()?.reduce(self.problem, parameters, free)
    }

    /// Every channel's triangle, in lanes or row by row.
    fn factors(
        &self,
        parameters: &[f64],
        free: &[usize],
    ) -> Result<Vec<ChannelFactor>, IdentificationError> {
        match self.triangles(parameters, free) {
            Some(triangles) => Ok(triangles.into_iter().map(ChannelFactor::new).collect()),
            None => self.factors_by_row(parameters, free),
        }
    }

    /// Every channel's triangle, row by row: what the lanes refuse is refused here with its line of the log.
    pub(crate) fn factors_by_row(
        &self,
        parameters: &[f64],
        free: &[usize],
    ) -> Result<Vec<ChannelFactor>, IdentificationError> {
        let mut all = vec![0.0; self.problem.residual_count()];
        let count = self.problem.parameter_count();
        let mut triangles: Vec<GatheredRows> = seen_columns(self.problem, free)
            .into_iter()
            .map(|columns| {
                let with_parameter = columns.iter().map(|&position| (position, free[position]));
                GatheredRows::new(with_parameter.collect(), count)
            })
            .collect();
        self.problem
            .run(parameters, &mut all, Sink::Triangles(&mut triangles))?;
        let finish = |triangle: GatheredRows| {
            Ok(ChannelFactor {
                columns: triangle.positions().collect(),
                of: (0..triangle.positions().count()).collect(),
                rows: triangle.finish()?,
            })
        };
        triangles.into_iter().map(finish).collect()
    }
}

impl Problem for ReducedProblem<'_> {
    fn parameter_count(&self) -> usize {
        self.problem.parameter_count()
    }

    fn residual_count(&self) -> usize {
        self.blocks.iter().map(|(_, rows)| rows).sum()
    }

    fn evaluate(
        &self,
        parameters: &[f64],
        residuals: &mut [f64],
        jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        residuals.fill(0.0);
        let Some((free, matrix)) = jacobian else {
            let square = self.cost(parameters)?;
            if let Some(first) = residuals.first_mut() {
                *first = square.sqrt();
            }
            return Ok(());
        };
        let factors = self.factors(parameters, free)?;
        for column in 0..matrix.columns() {
            matrix.column_mut(column).fill(0.0);
        }
        let mut first = 0;
        for (factor, (_, count)) in factors.iter().zip(&self.blocks) {
            let rows = first..first + factor.rows.rows();
            for (&column, &own) in factor.columns.iter().zip(&factor.of) {
                matrix.column_mut(column)[rows.clone()].copy_from_slice(factor.rows.column(own));
            }
            residuals[rows].copy_from_slice(factor.projected());
            first += count;
        }
        Ok(())
    }
}

impl ReducedProblem<'_> {
    /// Sum of squares of all residuals.
    fn cost(&self, parameters: &[f64]) -> Result<f64, IdentificationError> {
        if let Some(triangles) = self.triangles(parameters, &[]) {
            let rests = triangles
                .iter()
                .map(|channel| channel.triangle.rest_square());
            return Ok(rests.sum());
        }
        let mut all = vec![0.0; self.problem.residual_count()];
        self.problem.evaluate(parameters, &mut all, None)?;
        Ok(all.iter().map(|value| value * value).sum())
    }
}
