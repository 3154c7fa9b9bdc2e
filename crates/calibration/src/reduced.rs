//! The same least-squares problem with few rows: each channel is reduced to a triangle on the way.

use haptical_identification::{
    IdentificationError, Matrix, Observability, Problem, Reduction, Uncertainty,
};
use haptical_model::ModelError;

use crate::sink::{Sink, can_see};
use crate::{Channel, DeviceProblem};

/// Rows that are gathered before they are reduced: with 58 columns they fill a quarter of a
/// megabyte, which stays in the second-level cache, and the triangle above them costs a tenth.
const CHUNK_ROWS: usize = 512;

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
#[derive(Debug)]
pub struct ReducedProblem<'p> {
    problem: &'p DeviceProblem<'p>,
    /// Channel and number of rows, k_b + 1 for all parameters.
    blocks: Vec<(Channel, usize)>,
}

impl<'p> ReducedProblem<'p> {
    /// The reduced form of a problem.
    pub fn new(problem: &'p DeviceProblem<'p>) -> Self {
        let blocks = problem
            .channels()
            .map(|channel| {
                let seen = problem.parameters().iter();
                let count = seen.filter(|&&parameter| can_see(channel, parameter));
                (channel, count.count() + 1)
            })
            .collect();
        Self { problem, blocks }
    }

    /// Channels with the rows of their triangles, in order.
    pub fn layout(&self) -> &[(Channel, usize)] {
        &self.blocks
    }

    fn triangles(&self, free: &[usize]) -> Vec<Triangle> {
        let parameters = self.problem.parameters();
        self.blocks
            .iter()
            .map(|&(channel, _)| {
                let seen =
                    |&(_, parameter): &(usize, usize)| can_see(channel, parameters[parameter]);
                let columns = free.iter().copied().enumerate().filter(seen).collect();
                Triangle::new(columns, parameters.len())
            })
            .collect()
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
        let mut all = vec![0.0; self.problem.residual_count()];
        residuals.fill(0.0);
        let Some((free, matrix)) = jacobian else {
            self.problem.evaluate(parameters, &mut all, None)?;
            if let Some(first) = residuals.first_mut() {
                *first = all.iter().map(|value| value * value).sum::<f64>().sqrt();
            }
            return Ok(());
        };
        let mut triangles = self.triangles(free);
        self.problem
            .run(parameters, &mut all, Sink::Triangles(&mut triangles))?;
        for column in 0..matrix.columns() {
            matrix.column_mut(column).fill(0.0);
        }
        let mut first = 0;
        for (triangle, (_, rows)) in triangles.into_iter().zip(&self.blocks) {
            let columns = triangle.columns.clone();
            let factor = triangle.finish()?;
            for row in 0..factor.rows() {
                for (position, &(column, _)) in columns.iter().enumerate() {
                    matrix[(first + row, column)] = factor[(row, position)];
                }
                residuals[first + row] = factor[(row, columns.len())];
            }
            first += rows;
        }
        Ok(())
    }
}

/// `[J r]` of one channel, reduced whenever enough rows have been gathered.
#[derive(Debug)]
pub(crate) struct Triangle {
    /// Position within the free parameters, and parameter, of each column.
    columns: Vec<(usize, usize)>,
    /// Number of parameters: names the residual in errors.
    parameters: usize,
    /// Reduced rows first, then those gathered since; the last column is the residual.
    rows: Matrix,
    filled: usize,
    failure: Option<IdentificationError>,
}

impl Triangle {
    fn new(columns: Vec<(usize, usize)>, parameters: usize) -> Self {
        let width = columns.len() + 1;
        Self {
            rows: Matrix::zeros(CHUNK_ROWS.max(4 * width), width),
            columns,
            parameters,
            filled: 0,
            failure: None,
        }
    }

    /// Adds the rows of one reading; a failure of the arithmetic is told by [`Triangle::finish`].
    pub(crate) fn append(
        &mut self,
        index: usize,
        residuals: &[f64],
        mut derivative: impl FnMut(usize) -> Result<[f64; 3], ModelError>,
    ) -> Result<(), ModelError> {
        if self.filled + residuals.len() > self.rows.rows() {
            self.reduce();
        }
        for position in 0..self.columns.len() {
            let (_, parameter) = self.columns[position];
            let values = derivative(parameter)?;
            self.write(index, position, parameter, &values[..residuals.len()]);
        }
        self.write(index, self.columns.len(), self.parameters, residuals);
        self.filled += residuals.len();
        Ok(())
    }

    fn write(&mut self, index: usize, position: usize, parameter: usize, values: &[f64]) {
        for (axis, &value) in values.iter().enumerate() {
            self.rows[(self.filled + axis, position)] = value;
            if !value.is_finite() && self.failure.is_none() {
                self.failure = Some(IdentificationError::NotFinite {
                    row: index + axis,
                    column: parameter,
                    value,
                });
            }
        }
    }

    fn reduce(&mut self) {
        let width = self.rows.columns();
        if self.filled <= width {
            return;
        }
        let gathered = Matrix::from_fn(self.filled, width, |row, column| self.rows[(row, column)]);
        let all: Vec<usize> = (0..width).collect();
        let reduced = Reduction::new(&gathered, &vec![0.0; self.filled])
            .and_then(|reduction| reduction.scaled_factor(&all, reduction.column_norms()));
        self.filled = match reduced {
            Ok(factor) => {
                for column in 0..width {
                    self.rows.column_mut(column)[..factor.rows()]
                        .copy_from_slice(factor.column(column));
                }
                factor.rows()
            }
            Err(error) => {
                self.failure.get_or_insert_with(|| error.into());
                0
            }
        };
    }

    /// At most one row more than there are parameter columns.
    fn finish(mut self) -> Result<Matrix, IdentificationError> {
        self.reduce();
        match self.failure {
            Some(failure) => Err(failure),
            None => Ok(Matrix::from_fn(
                self.filled,
                self.rows.columns(),
                |row, column| self.rows[(row, column)],
            )),
        }
    }
}

/// Turns a covariance for the stated noise into that for noise of the residuals' own size: times
/// cost / degrees of freedom.
pub(crate) fn scale_to_residuals(spread: &mut Uncertainty, cost: f64) {
    spread.noise_factor = (cost / spread.degrees_of_freedom as f64).sqrt();
    let square = spread.noise_factor * spread.noise_factor;
    for column in 0..spread.columns.len() {
        let entries = spread.covariance.column_mut(column).iter_mut();
        entries.for_each(|entry| *entry *= square);
    }
}

/// The observability indices for `rows` readings instead of those of the triangles: only O1 counts
/// them, as 1/sqrt(m).
pub(crate) fn count_readings(index: &mut Observability, reduced_rows: usize, rows: usize) {
    index.o1 *= (reduced_rows as f64 / rows as f64).sqrt();
}
