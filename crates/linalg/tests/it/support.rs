//! Random matrices, and translations between ours and nalgebra's.

use haptical_linalg::Matrix;
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

/// Entries in -1..1, column by column.
pub(crate) fn matrix(rows: usize, columns: usize) -> impl Strategy<Value = Matrix> {
    prop::collection::vec(-1.0..1.0_f64, rows * columns)
        .prop_map(move |data| Matrix::from_fn(rows, columns, |r, c| data[c * rows + r]))
}

/// A tall matrix of up to 7 columns with a right-hand side.
pub(crate) fn tall_problem() -> impl Strategy<Value = (Matrix, Vec<f64>)> {
    (1..8_usize, 0..30_usize).prop_flat_map(|(columns, extra)| {
        let rows = columns + 2 + extra;
        (
            matrix(rows, columns),
            prop::collection::vec(-1.0..1.0_f64, rows),
        )
    })
}

pub(crate) fn dense(matrix: &Matrix) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.rows(), matrix.columns(), |r, c| matrix[(r, c)])
}

/// The matrix with unit-norm columns, and the norms.
pub(crate) fn normalised(matrix: &Matrix) -> (DMatrix<f64>, Vec<f64>) {
    let mut scaled = dense(matrix);
    let norms = scaled.column_iter().map(|column| column.norm()).collect();
    for mut column in scaled.column_iter_mut() {
        column.normalize_mut();
    }
    (scaled, norms)
}

/// Condition number of the unit-norm columns, from nalgebra.
pub(crate) fn condition(matrix: &Matrix) -> f64 {
    let values = normalised(matrix).0.singular_values();
    values.max() / values.min()
}

/// Least squares by nalgebra's singular value decomposition of the unit-norm columns.
pub(crate) fn svd_least_squares(matrix: &Matrix, rhs: &[f64]) -> Vec<f64> {
    let (scaled, norms) = normalised(matrix);
    let solution = scaled
        .svd(true, true)
        .solve(&DVector::from_column_slice(rhs), 0.0)
        .unwrap();
    solution.iter().zip(&norms).map(|(x, n)| x / n).collect()
}

pub(crate) fn all_columns(matrix: &Matrix) -> Vec<usize> {
    (0..matrix.columns()).collect()
}

/// Largest difference relative to the largest reference entry.
pub(crate) fn relative_difference(values: &[f64], reference: &[f64]) -> f64 {
    assert_eq!(values.len(), reference.len());
    let largest = |entries: &mut dyn Iterator<Item = f64>| entries.fold(0.0, f64::max);
    let scale = largest(&mut reference.iter().map(|x| x.abs()));
    let difference = largest(&mut values.iter().zip(reference).map(|(a, b)| (a - b).abs()));
    difference / scale.max(f64::MIN_POSITIVE)
}

/// That many cases, and an end to shrinking: filtered strategies could go on for minutes.
pub(crate) fn cases(cases: u32) -> proptest::test_runner::Config {
    proptest::test_runner::Config {
        cases,
        max_shrink_iters: 500,
        ..proptest::test_runner::Config::default()
    }
}
