//! The rows of one sensor in the few columns that it sees.

use haptical_linalg::Triangle;
use nalgebra::{DMatrix, SVD};

use super::problem::OrderedProblem;

/// The rows of one group.
pub(super) struct Group {
    /// Their places in the problem.
    pub(super) rows: Vec<usize>,
    /// Orthonormal columns that span the group's derivatives.
    pub(super) basis: DMatrix<f64>,
    /// Their coordinates, a row each, by the coordinates of the whole.
    pub(super) coordinates: DMatrix<f64>,
    /// Measurement minus model.
    pub(super) readings: Vec<f64>,
    /// Derivatives by parameters that the fit held.
    pub(super) held: DMatrix<f64>,
}

/// Singular value of a direction in a group, as a share of the largest, that is rounding: another group shows it, or none does.
const ROUNDING: f64 = 1e-12;

/// Rounds of a decomposition: a few for each column are usual.
const MOST_ROUNDS: usize = 10_000;

impl Group {
    /// `norms` are those of all rows' columns.
    pub(super) fn new(
        problem: &OrderedProblem<'_>,
        rows: Vec<usize>,
        norms: &[f64],
    ) -> Option<Self> {
        let entries = |column: usize| {
            let entries = problem.derivatives.column(column);
            rows.iter().map(|&row| entries[row])
        };
        let seen: Vec<usize> = (0..norms.len())
            .filter(|&column| entries(column).any(|entry| entry != 0.0))
            .collect();
        let mut unit = DMatrix::zeros(rows.len(), seen.len());
        for (mut into, &column) in unit.column_iter_mut().zip(&seen) {
            for (into, entry) in into.iter_mut().zip(entries(column)) {
                *into = entry / norms[column];
            }
        }
        let (vectors, roots) = directions(&unit)?;
        let turned = DMatrix::from_fn(seen.len(), roots.len(), |row, k| {
            vectors[(row, k)] / roots[k]
        });
        let mut coordinates = DMatrix::zeros(roots.len(), norms.len());
        for (place, &column) in seen.iter().enumerate() {
            for (k, root) in roots.iter().enumerate() {
                coordinates[(k, column)] = vectors[(place, k)] * root;
            }
        }
        let held = problem.derivatives.columns() - norms.len();
        Some(Self {
            basis: unit * turned,
            coordinates,
            readings: rows.iter().map(|&row| -problem.residuals[row]).collect(),
            held: DMatrix::from_fn(rows.len(), held, |place, column| {
                problem.derivatives[(rows[place], norms.len() + column)]
            }),
            rows,
        })
    }
}

/// Right singular vectors of columns, and singular values, without those that are rounding; none where they cannot be found.
///
/// From the columns' triangle, not from their products with each other, whose rounding would be a direction of a square of 1e-14.
fn directions(columns: &DMatrix<f64>) -> Option<(DMatrix<f64>, Vec<f64>)> {
    let count = columns.ncols();
    if count == 0 {
        return Some((DMatrix::zeros(0, 0), Vec::new()));
    }
    let mut triangle = Triangle::new(count);
    let entries: Vec<&[f64]> = columns.as_slice().chunks_exact(columns.nrows()).collect();
    triangle
        .fold_rows(&entries, &vec![0.0; columns.nrows()])
        .ok()?;
    let factor = DMatrix::from_fn(count, count, |row, column| match row <= column {
        true => triangle.entry(row, column),
        false => 0.0,
    });
    let found = SVD::try_new(factor, false, true, 5.0 * f64::EPSILON, MOST_ROUNDS)?;
    let values = &found.singular_values;
    let least = ROUNDING * values.max();
    let kept: Vec<usize> = (0..count).filter(|&k| values[k] > least).collect();
    let roots = kept.iter().map(|&k| values[k]).collect();
    let vectors = found.v_t?.transpose();
    Some((vectors.select_columns(&kept), roots))
}
