//! Independence of columns in an order of preference (Khalil & Dombre 2002, section 10.2.2).
//!
//! The textbook reads it off the diagonal of an un-pivoted QR. Neither a rank-revealing QR (its
//! diagonal no longer belongs to the columns) nor a plain Householder QR of a square triangle (each
//! dependent column uses up one of the few remaining directions) gives that reading, so the columns
//! are orthogonalised one by one, twice each ("twice is enough": Giraud, Langou & Rozložník 2005),
//! and a column whose remainder is negligible is left out and does not use up a direction.

use crate::Matrix;
use crate::lanes::{product, subtract};

/// Which columns are kept, which vanish, which depend on kept ones.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderedRank {
    /// Independent columns, in the order in which they were offered.
    pub independent: Vec<usize>,
    /// Columns that are zero.
    pub zero: Vec<usize>,
    /// Columns that are combinations of independent ones offered before them.
    pub dependent: Vec<Dependence>,
    /// Smallest remainder of a kept unit-norm column.
    pub smallest_kept: f64,
    /// Largest remainder of a column that was left out (0 if none was).
    pub largest_dropped: f64,
}

/// A column as a combination of kept ones.
#[derive(Debug, Clone, PartialEq)]
pub struct Dependence {
    /// The column that was left out.
    pub column: usize,
    /// Kept columns and coefficients in unscaled units: column = sum of coefficient times kept.
    pub combination: Vec<(usize, f64)>,
}

/// Coefficients below this share of the largest (both scaled to unit-norm columns) are rounding.
const COEFFICIENT_CUT: f64 = 1e-6;

pub(crate) fn ordered_rank(
    scaled: &Matrix,
    order: &[usize],
    norms: &[f64],
    tolerance: f64,
) -> OrderedRank {
    let mut result = OrderedRank {
        independent: Vec::new(),
        zero: Vec::new(),
        dependent: Vec::new(),
        smallest_kept: f64::INFINITY,
        largest_dropped: 0.0,
    };
    let mut basis: Vec<Vec<f64>> = Vec::new();
    // Column k holds the components of the k-th kept column along the basis: upper triangular.
    let mut triangle: Vec<Vec<f64>> = Vec::new();
    for (position, &column) in order.iter().enumerate() {
        if norms[column] == 0.0 {
            result.zero.push(column);
            continue;
        }
        let mut remainder = scaled.column(position).to_vec();
        let mut components = vec![0.0; basis.len()];
        for _ in 0..2 {
            for (direction, component) in basis.iter().zip(&mut components) {
                let share = product(direction, &remainder);
                *component += share;
                subtract(&mut remainder, share, direction);
            }
        }
        let size = product(&remainder, &remainder).sqrt();
        if size > tolerance && basis.len() < scaled.rows() {
            remainder.iter_mut().for_each(|value| *value /= size);
            basis.push(remainder);
            components.push(size);
            triangle.push(components);
            result.independent.push(column);
            result.smallest_kept = result.smallest_kept.min(size);
        } else {
            result.largest_dropped = result.largest_dropped.max(size);
            let combination = combination(&triangle, components, &result.independent, norms);
            let combination = combination
                .into_iter()
                .map(|(kept, value)| (kept, value * norms[column]))
                .collect();
            result.dependent.push(Dependence {
                column,
                combination,
            });
        }
    }
    result
}

/// Solves the triangle of kept columns for the components of a dependent one.
fn combination(
    triangle: &[Vec<f64>],
    mut components: Vec<f64>,
    kept: &[usize],
    norms: &[f64],
) -> Vec<(usize, f64)> {
    for index in (0..components.len()).rev() {
        components[index] /= triangle[index][index];
        let value = components[index];
        for (row, component) in components.iter_mut().enumerate().take(index) {
            *component -= triangle[index][row] * value;
        }
    }
    let largest = components
        .iter()
        .fold(0.0_f64, |largest, value| largest.max(value.abs()));
    components
        .iter()
        .zip(kept)
        .filter(|(value, _)| value.abs() > COEFFICIENT_CUT * largest)
        .map(|(value, &column)| (column, value / norms[column]))
        .collect()
}
