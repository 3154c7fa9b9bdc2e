//! The rows of a problem group by group, with orthonormal columns, and weighted least squares over them.
//!
//! The rows of a group depend on some parameters only: an external encoder on those of its transmission. Derivatives of a group are
//! its orthonormal columns times a matrix, and whatever sums rows is a product of few columns that this matrix takes to all
//! parameters. Source: docs/equations.md, Noise with memory.

use std::ops::Range;

use haptical_linalg::Matrix;
use nalgebra::DMatrix;

use super::group::Group;
use super::least_squares::{Normal, Products, SMALLEST_PIVOT, Scaled};
use super::problem::OrderedProblem;

/// The derivatives in groups, what the fit may still change, and the way back to the parameters.
pub(super) struct Rows {
    /// Those of each group of signals, then the others where there are any.
    pub(super) groups: Vec<Group>,
    /// Places of each signal's rows in its group.
    pub(super) places: Vec<Range<usize>>,
    /// Parameters by coordinates in which the derivatives' columns are orthonormal.
    pub(super) to_parameters: DMatrix<f64>,
    /// Covariance of held parameters that an earlier step fitted; zero for the others.
    known: DMatrix<f64>,
}

impl Rows {
    pub(super) fn new(problem: &OrderedProblem<'_>) -> Option<Self> {
        let (rows, count) = (problem.residuals.len(), problem.fitted);
        let held = problem.derivatives.columns().checked_sub(count)?;
        if rows <= count || count == 0 || problem.derivatives.rows() != rows {
            return None;
        }
        let norm = |column: usize| {
            let entries = problem.derivatives.column(column).iter();
            let norm = entries.map(|entry| entry * entry).sum::<f64>().sqrt();
            (norm > 0.0 && norm.is_finite()).then_some(norm)
        };
        let norms: Vec<f64> = (0..count).map(norm).collect::<Option<_>>()?;
        let (groups, places) = rows_of_groups(problem);
        let groups = groups
            .into_iter()
            .map(|rows| Group::new(problem, rows, &norms));
        let mut groups: Vec<Group> = groups.collect::<Option<_>>()?;
        // one below the other, which leaves their columns as they are
        let sizes = groups.iter().map(|group| group.coordinates.nrows());
        let mut stacked = DMatrix::zeros(sizes.sum(), count);
        let mut first = 0;
        for group in &groups {
            let part = &group.coordinates;
            stacked.rows_mut(first, part.nrows()).copy_from(part);
            first += part.nrows();
        }
        if stacked.nrows() < count {
            return None;
        }
        let triangle = stacked.qr().r();
        if !(0..count).all(|k| triangle[(k, k)].powi(2) > SMALLEST_PIVOT) {
            return None;
        }
        let inverse = triangle.solve_upper_triangular(&DMatrix::identity(count, count))?;
        for group in &mut groups {
            group.coordinates = &group.coordinates * &inverse;
        }
        let known = |a: usize, b: usize| problem.known.map_or(0.0, |known| known[(a, b)]);
        Some(Self {
            groups,
            places,
            to_parameters: DMatrix::from_fn(count, count, |row, column| {
                inverse[(row, column)] / norms[row]
            }),
            known: DMatrix::from_fn(held, held, known),
        })
    }

    pub(super) fn parameters(&self) -> usize {
        self.to_parameters.nrows()
    }

    pub(super) fn held(&self) -> usize {
        self.known.nrows()
    }

    /// Weighted least squares with a standard deviation for every row of every group: scaled residuals, and the room 1 - h of each.
    pub(super) fn solved(&self, sizes: &[Vec<f64>]) -> Option<Vec<Scaled>> {
        let both = self.groups.iter().zip(sizes);
        let products: Vec<Products> = both
            .clone()
            .map(|(group, sizes)| group.products(0..group.rows.len(), sizes))
            .collect();
        let mut normal = Normal::new(self.parameters());
        for (group, products) in self.groups.iter().zip(&products) {
            normal.add(group, products);
        }
        let solved = normal.solved()?;
        let scaled = both.map(|(group, sizes)| {
            let solved = solved.of_group(group);
            Scaled {
                residuals: solved.scaled_residuals(group, sizes),
                rooms: solved.rooms(group, sizes),
            }
        });
        Some(scaled.collect())
    }

    /// Expected power of what earlier steps' errors add, by the products of held parameters' parts.
    pub(super) fn leaked(&self, held: &DMatrix<f64>) -> f64 {
        self.known.dot(held)
    }
}

/// Rows of each group, signal after signal, then those of none; and the places of each signal's rows in its group.
fn rows_of_groups(problem: &OrderedProblem<'_>) -> (Vec<Vec<usize>>, Vec<Range<usize>>) {
    let groups = problem.signals.iter().map(|signal| signal.group + 1).max();
    let mut rows = vec![Vec::new(); groups.unwrap_or(0)];
    let mut is_of_none = vec![true; problem.residuals.len()];
    let mut places = Vec::with_capacity(problem.signals.len());
    for signal in problem.signals {
        let of_group = &mut rows[signal.group];
        places.push(of_group.len()..of_group.len() + signal.rows.len());
        of_group.extend_from_slice(&signal.rows);
        signal.rows.iter().for_each(|&row| is_of_none[row] = false);
    }
    let others: Vec<usize> = (0..is_of_none.len())
        .filter(|&row| is_of_none[row])
        .collect();
    if !others.is_empty() {
        rows.push(others);
    }
    (rows, places)
}

/// A line in time, from -1/2 to 1/2 over the signal.
pub(super) fn along(place: usize, count: usize) -> f64 {
    (place as f64 + 0.5) / count as f64 - 0.5
}

/// A dense matrix of the other kind.
pub(super) fn as_matrix(dense: &DMatrix<f64>) -> Matrix {
    Matrix::from_fn(dense.nrows(), dense.ncols(), |row, column| {
        dense[(row, column)]
    })
}
