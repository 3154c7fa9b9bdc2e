//! Least squares of a few columns.

use nalgebra::{DMatrix, DVector};

use super::Held;

/// Sums of products.
pub(crate) struct Normal;

impl Normal {
    /// Coefficients on the rows that are not held out, and the residual on all rows.
    pub(crate) fn solve(columns: &[&[f64]], target: &[f64], held: &Held) -> (Vec<f64>, Vec<f64>) {
        let count = columns.len();
        if count == 0 {
            return (Vec::new(), target.to_vec());
        }
        let is_seen = |row: &usize| held.as_ref().is_none_or(|held| !held.contains(row));
        let rows: Vec<usize> = (0..target.len()).filter(is_seen).collect();
        // about their means, so that a constant beside sines of small angles is no cancellation
        let product = |a: &[f64], b: &[f64]| rows.iter().map(|&row| a[row] * b[row]).sum::<f64>();
        let mut matrix = DMatrix::from_fn(count, count, |i, j| {
            if j > i {
                0.0
            } else {
                product(columns[i], columns[j])
            }
        });
        matrix.fill_upper_triangle_with_lower_triangle();
        let right = DVector::from_fn(count, |i, _| product(columns[i], target));
        let solution = solve_scaled(matrix, &right);
        let residual = (0..target.len())
            .map(|row| {
                let predicted = columns.iter().zip(&solution);
                target[row] - predicted.map(|(column, c)| column[row] * c).sum::<f64>()
            })
            .collect();
        (solution, residual)
    }
}

/// Solves normal equations, columns scaled to 1 and the weakest directions held by a ridge of 1e-9.
pub(crate) fn solve_scaled(mut matrix: DMatrix<f64>, right: &DVector<f64>) -> Vec<f64> {
    let count = right.len();
    let scale: Vec<f64> = (0..count)
        .map(|i| matrix[(i, i)].max(1e-300).sqrt())
        .collect();
    for i in 0..count {
        for j in 0..count {
            matrix[(i, j)] /= scale[i] * scale[j];
        }
        matrix[(i, i)] += 1e-9;
    }
    let scaled = DVector::from_fn(count, |i, _| right[i] / scale[i]);
    let Some(factor) = matrix.cholesky() else {
        return vec![0.0; count];
    };
    let solution = factor.solve(&scaled);
    (0..count).map(|i| solution[i] / scale[i]).collect()
}
