//! Steps from a triangle as it is, without another decomposition, where its rank is proven.

use haptical_linalg::{Reduction, Solution, Triangle};

use crate::lanes::{LANES, product, subtract};
use crate::problem::sum_of_squares;
use crate::{IdentificationError, TriangleProblem};

/// The linearised problem of a [`TriangleProblem`]: R x - q, R upper triangular, with R also at unit columns.
///
/// A pivoted QR is there to decide the rank. Where a bound proves that it would find full rank, back
/// substitution gives the same step for a hundredth of the work; where not, the pivoted QR decides.
#[derive(Debug)]
pub(crate) struct UnitTriangle {
    triangle: Triangle,
    /// Rows that its reduction has.
    rows: usize,
    pub(crate) norms: Vec<f64>,
    /// R with unit columns, column by column.
    unit: Vec<f64>,
    /// Lower bound of the smallest singular value of the unit columns.
    least: f64,
}

impl UnitTriangle {
    /// The problem at a point.
    pub(crate) fn new(
        problem: &dyn TriangleProblem,
        parameters: &[f64],
        free: &[usize],
    ) -> Result<Self, IdentificationError> {
        let count = free.len();
        let mut made = Self {
            triangle: Triangle::new(count),
            rows: problem.columns() + 1,
            norms: vec![0.0; count],
            unit: vec![0.0; count * count],
            least: 0.0,
        };
        problem.reduce_into(parameters, free, &mut made.triangle)?;
        for column in 0..count {
            let entries = made.triangle.column(column);
            let norm = sum_of_squares(entries).sqrt();
            made.norms[column] = norm;
            let scale = if norm > 0.0 { 1.0 / norm } else { 1.0 };
            let unit = &mut made.unit[column * count..][..=column];
            for (unit, entry) in unit.iter_mut().zip(entries) {
                *unit = entry * scale;
            }
        }
        made.least = made.least_singular_value();
        Ok(made)
    }

    /// Whether all numbers are finite, and so are the norms.
    pub(crate) fn is_finite(&self) -> bool {
        let numbers = self.norms.iter().chain(self.triangle.projected());
        numbers
            .chain([&self.triangle.rest_square()])
            .all(|number| number.is_finite())
    }

    /// The residuals of the triangle: q, the root of the rest, zeros.
    pub(crate) fn residuals(&self) -> Vec<f64> {
        let mut residuals = vec![0.0; self.rows];
        self.triangle.write_into(&mut residuals, None);
        residuals
    }

    pub(crate) fn reduction(&self) -> Result<Reduction, IdentificationError> {
        Ok(self.triangle.reduction(self.rows)?)
    }

    fn diagonal(&self, index: usize) -> f64 {
        self.unit[index * self.norms.len() + index]
    }

    /// A lower bound: 1 / (sqrt(n) max y) with y the solution of M y = (1, ..., 1), M the comparison
    /// matrix of the triangle, as |F^-1| <= M^-1 entry by entry
    /// (Higham, *Accuracy and Stability of Numerical Algorithms*, section 8.2).
    fn least_singular_value(&self) -> f64 {
        let count = self.norms.len();
        let mut y = vec![1.0; count];
        let mut most = 0.0_f64;
        for column in (0..count).rev() {
            y[column] /= self.diagonal(column).abs();
            most = most.max(y[column]);
            let solved = y[column];
            let entries = &self.unit[column * count..][..column];
            for (rest, entry) in y.iter_mut().zip(entries) {
                *rest += entry.abs() * solved;
            }
        }
        // a zero on the diagonal makes infinity, infinity times zero NaN: neither proves anything
        let least = 1.0 / ((count as f64).sqrt() * most);
        if y.iter().all(|entry| entry.is_finite()) {
            least
        } else {
            0.0
        }
    }

    /// The undamped step; none where full rank is not proven.
    ///
    /// The pivots of a pivoted QR are at least the smallest singular value, the largest pivot at most
    /// 1, the norm of a column.
    pub(crate) fn newton(&self, tolerance: f64) -> Option<Solution> {
        if self.least <= PROOF_MARGIN * tolerance {
            return None;
        }
        let mut step = self.triangle.projected().to_vec();
        back_substitute(&self.unit, &mut step);
        self.solution(step, sum_of_squares(self.triangle.projected()), 0.0)
    }

    /// The damped step, as [`Reduction::solve_weighted`]; none where full rank is not proven.
    pub(crate) fn damped(&self, damping: f64, weights: &[f64], tolerance: f64) -> Option<Solution> {
        let count = self.norms.len();
        let root = damping.sqrt();
        let mut longest = 1.0_f64;
        let mut least = f64::INFINITY;
        for weight in weights {
            let entry = root * weight;
            longest = longest.max(entry.hypot(1.0));
            least = least.min(entry / entry.hypot(1.0));
        }
        let least = least.max(self.least / longest);
        if !longest.is_finite() || least.is_nan() || least <= PROOF_MARGIN * tolerance {
            return None;
        }
        let mut triangle = self.unit.clone();
        let mut step = self.triangle.projected().to_vec();
        let height = count.next_multiple_of(LANES);
        let mut below = vec![0.0; count * height];
        for (index, weight) in weights.iter().enumerate() {
            below[index * height + index] = root * weight;
        }
        fold(&mut triangle, &mut step, &mut below);
        back_substitute(&triangle, &mut step);
        let (mut misfit, mut explained) = (0.0, 0.0);
        for row in 0..count {
            let terms = (row..count).map(|column| self.unit[column * count + row] * step[column]);
            let (have, fit) = (self.triangle.projected()[row], terms.sum::<f64>());
            misfit += (have - fit) * (have - fit);
            explained += fit * (2.0 * have - fit);
        }
        self.solution(step, explained, misfit)
    }

    fn solution(&self, mut step: Vec<f64>, explained_square: f64, misfit: f64) -> Option<Solution> {
        for (value, norm) in step.iter_mut().zip(&self.norms) {
            *value = if *norm > 0.0 { *value / norm } else { 0.0 };
        }
        // what overflows is refused in the other way, with its reason
        let is_sound = step.iter().all(|value| value.is_finite());
        is_sound.then_some(Solution {
            rank: self.norms.len(),
            values: step,
            residual_square: self.triangle.rest_square() + misfit,
            explained_square,
        })
    }
}

/// The bounds are worked out in rounded arithmetic themselves.
const PROOF_MARGIN: f64 = 2.0;

/// Solves the upper triangle, stored column by column, for `values` in place.
fn back_substitute(triangle: &[f64], values: &mut [f64]) {
    let count = values.len();
    for column in (0..count).rev() {
        let entries = &triangle[column * count..][..=column];
        let solved = values[column] / entries[column];
        values[column] = solved;
        subtract(values, solved, &entries[..column]);
    }
}

/// Folds the matrix `below`, diagonal at first, into the triangle by Householder reflections; its columns
/// are filled up with zeros to a multiple of [`LANES`].
///
/// Column j of `below` fills up to row j and no further, so reflection j has its entry of the triangle
/// and j + 1 rows (Lawson & Hanson, *Solving Least Squares Problems*, chapter 27); beyond these its own
/// column is zero, and the rows are left as they are. The right-hand side of `below` is zero at first.
fn fold(triangle: &mut [f64], rhs: &mut [f64], below: &mut [f64]) {
    let count = rhs.len();
    let height = count.next_multiple_of(LANES);
    let mut rhs_below = vec![0.0; height];
    for column in 0..count {
        let (left, right) = below.split_at_mut((column + 1) * height);
        let rows = (column + 1).next_multiple_of(LANES);
        let x = &left[column * height..][..rows];
        let square = product(x, x);
        let alpha = triangle[column * count + column];
        if square == 0.0 {
            continue;
        }
        let norm = (alpha * alpha + square).sqrt();
        let beta = if alpha >= 0.0 { -norm } else { norm };
        let scale = 1.0 / (alpha - beta);
        let tau = (beta - alpha) / beta;
        triangle[column * count + column] = beta;
        let reflect = |top: &mut f64, bottom: &mut [f64]| {
            let change = tau * (*top + scale * product(x, bottom));
            *top -= change;
            subtract(bottom, scale * change, x);
        };
        for (bottom, other) in right.chunks_exact_mut(height).zip(column + 1..) {
            reflect(&mut triangle[other * count + column], &mut bottom[..rows]);
        }
        reflect(&mut rhs[column], &mut rhs_below[..rows]);
    }
}
