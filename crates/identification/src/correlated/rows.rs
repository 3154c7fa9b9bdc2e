//! The rows of a problem with orthonormal columns, and weighted least squares over them.

use haptical_linalg::Matrix;
use nalgebra::{Cholesky, DMatrix, DVector};

use super::problem::OrderedProblem;

/// Columns that span the derivatives, what the fit may still change, and the way back to the parameters.
pub(super) struct Rows {
    /// Orthonormal columns, rows x parameters.
    pub(super) basis: DMatrix<f64>,
    /// Parameters by coordinates of the basis.
    pub(super) to_parameters: DMatrix<f64>,
    /// Measurement minus model.
    pub(super) readings: DVector<f64>,
    /// Derivatives by parameters that the fit held.
    pub(super) held: DMatrix<f64>,
    /// Covariance of those of them that an earlier step fitted; zero for the others.
    known: DMatrix<f64>,
}

/// Least room that a row leaves its residual: one that the fit follows exactly says nothing of the noise.
pub(super) const LEAST_ROOM: f64 = 0.05;
/// Pivot of unit columns below which a direction is rounding.
const SMALLEST_PIVOT: f64 = 1e-12;

impl Rows {
    pub(super) fn new(problem: &OrderedProblem<'_>) -> Option<Self> {
        let (rows, count) = (problem.residuals.len(), problem.derivatives.columns());
        if rows <= count || count == 0 || problem.derivatives.rows() != rows {
            return None;
        }
        let mut unit = DMatrix::zeros(rows, count);
        let mut norms = Vec::with_capacity(count);
        for column in 0..count {
            let entries = problem.derivatives.column(column);
            let norm = entries
                .iter()
                .map(|entry| entry * entry)
                .sum::<f64>()
                .sqrt();
            if !(norm > 0.0 && norm.is_finite()) {
                return None;
            }
            norms.push(norm);
            for (own, entry) in unit.column_mut(column).iter_mut().zip(entries) {
                *own = entry / norm;
            }
        }
        let mut triangle: DMatrix<f64> = DMatrix::identity(count, count);
        // Gram-Schmidt by Cholesky, twice: the second makes the columns orthogonal to rounding (Yamamoto et al. 2015)
        for _ in 0..2 {
            let gram = unit.transpose() * &unit;
            let inverse = inverse_factor(gram)?.transpose();
            unit *= &inverse;
            triangle *= inverse;
        }
        let held = match problem.held {
            None => DMatrix::zeros(rows, 0),
            Some(held) if held.derivatives.rows() != rows => return None,
            Some(held) => DMatrix::from_fn(rows, held.derivatives.columns(), |row, column| {
                held.derivatives[(row, column)]
            }),
        };
        let known = DMatrix::from_fn(held.ncols(), held.ncols(), |a, b| {
            problem.held.map_or(0.0, |held| held.known[(a, b)])
        });
        let by_norm = |row: usize, column: usize| triangle[(row, column)] / norms[row];
        Some(Self {
            basis: unit,
            to_parameters: DMatrix::from_fn(count, count, by_norm),
            readings: DVector::from_iterator(rows, problem.residuals.iter().map(|r| -r)),
            held,
            known,
        })
    }

    /// Weighted least squares with a standard deviation for every row: scaled residuals, and the room 1 - h of each.
    pub(super) fn scaled_residuals(&self, sizes: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
        let every: Vec<usize> = (0..sizes.len()).collect();
        let solved = self.products(&every, sizes).solved()?;
        let rest = solved.scaled_residuals(self, sizes);
        let way = solved.inverse.transpose();
        let mut rooms = Vec::with_capacity(sizes.len());
        for first in (0..sizes.len()).step_by(AT_ONCE) {
            let sizes = &sizes[first..(first + AT_ONCE).min(sizes.len())];
            let spanned = self.basis.rows(first, sizes.len()) * &way;
            let shares = sizes.iter().enumerate();
            rooms.extend(shares.map(|(row, size)| {
                let share = spanned.row(row).norm_squared() / (size * size);
                (1.0 - share).max(LEAST_ROOM)
            }));
        }
        Some((rest, rooms))
    }

    /// Products of some rows' columns over their sizes with each other and with the readings.
    pub(super) fn products(&self, rows: &[usize], sizes: &[f64]) -> Products {
        let count = self.basis.ncols();
        let mut found = Products {
            rows: rows.len(),
            gram: DMatrix::zeros(count, count),
            along: DVector::zeros(count),
        };
        for rows in rows.chunks(AT_ONCE) {
            let weighted = DMatrix::from_fn(rows.len(), count, |place, column| {
                self.basis[(rows[place], column)] / sizes[rows[place]]
            });
            let readings = DVector::from_fn(rows.len(), |place, _| {
                self.readings[rows[place]] / sizes[rows[place]]
            });
            let across = weighted.transpose();
            found.gram.gemm(1.0, &across, &weighted, 1.0);
            found.along.gemv(1.0, &across, &readings, 1.0);
        }
        found
    }

    /// Expected power of what earlier steps' errors add, by the products of held parameters' parts.
    pub(super) fn leaked(&self, held: &DMatrix<f64>) -> f64 {
        self.known.dot(held)
    }

    pub(super) fn weighted(&self, sizes: &[f64]) -> DMatrix<f64> {
        let mut weighted = self.basis.clone();
        for mut column in weighted.column_iter_mut() {
            for (entry, size) in column.iter_mut().zip(sizes) {
                *entry /= size;
            }
        }
        weighted
    }
}

/// Rows that are looked at at once: their columns stay in the processor's cache.
const AT_ONCE: usize = 512;

/// Products of some rows: their normal equations.
#[derive(Clone)]
pub(super) struct Products {
    rows: usize,
    gram: DMatrix<f64>,
    along: DVector<f64>,
}

impl Products {
    /// The same with further rows, all of whose sizes are `size` times theirs.
    pub(super) fn add(&mut self, other: &Self, size: f64) {
        let weight = 1.0 / (size * size);
        self.rows += other.rows;
        self.gram
            .zip_apply(&other.gram, |sum, more| *sum += weight * more);
        self.along.axpy(weight, &other.along, 1.0);
    }

    /// Their solution; none where they are not of full rank.
    pub(super) fn solved(&self) -> Option<Solved> {
        let inverse = inverse_factor(self.gram.clone())?;
        let coordinates = inverse.tr_mul(&(&inverse * &self.along));
        Some(Solved {
            inverse,
            coordinates,
        })
    }

    /// Room that a solution leaves these rows, all of whose sizes are `size` times theirs.
    pub(super) fn room(&self, solved: &Solved, size: f64) -> f64 {
        let spanned = &solved.inverse * &self.gram * solved.inverse.transpose();
        let rows = self.rows as f64;
        (rows - spanned.trace() / (size * size)).max(LEAST_ROOM * rows)
    }
}

/// A weighted fit.
pub(super) struct Solved {
    /// The inverse of the lower Cholesky factor of its normal matrix.
    inverse: DMatrix<f64>,
    coordinates: DVector<f64>,
}

impl Solved {
    /// Residuals over sizes.
    pub(super) fn scaled_residuals(&self, rows: &Rows, sizes: &[f64]) -> Vec<f64> {
        let mut rest = rows.readings.clone();
        rest.gemv(-1.0, &rows.basis, &self.coordinates, 1.0);
        let each = rest.iter().zip(sizes);
        each.map(|(rest, size)| rest / size).collect()
    }
}

/// A line in time, from -1/2 to 1/2 over the signal.
pub(super) fn along(place: usize, count: usize) -> f64 {
    (place as f64 + 0.5) / count as f64 - 0.5
}

/// The room 1 - h of every row, h its share of orthonormal columns.
pub(super) fn rooms(spanned: &DMatrix<f64>) -> Vec<f64> {
    let mut rooms = vec![1.0; spanned.nrows()];
    for column in spanned.column_iter() {
        for (room, entry) in rooms.iter_mut().zip(column.iter()) {
            *room -= entry * entry;
        }
    }
    rooms
        .iter_mut()
        .for_each(|room| *room = room.max(LEAST_ROOM));
    rooms
}

/// The inverse of the lower Cholesky factor; none for a matrix that is not of full rank.
pub(super) fn inverse_factor(gram: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let count = gram.nrows();
    let diagonal: Vec<f64> = (0..count).map(|k| gram[(k, k)]).collect();
    let factor = Cholesky::new(gram)?.unpack();
    let is_sound = |k: usize| factor[(k, k)].powi(2) > SMALLEST_PIVOT * diagonal[k];
    if !(0..count).all(is_sound) {
        return None;
    }
    factor.solve_lower_triangular(&DMatrix::identity(count, count))
}

/// A dense matrix of the other kind.
pub(super) fn as_matrix(dense: &DMatrix<f64>) -> Matrix {
    Matrix::from_fn(dense.nrows(), dense.ncols(), |row, column| {
        dense[(row, column)]
    })
}
