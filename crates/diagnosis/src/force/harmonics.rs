//! Cosines and sines of multiples of a motor's angle: fast cogging that would pass for noise.

use haptical_effects::force::COGGING_ORDERS;
use nalgebra::{DMatrix, DVector};

/// Highest order of cogging that is tried.
pub(super) const ORDERS: usize = COGGING_ORDERS;

/// Cosines and sines of multiples of the motor's angle (`ratio` times the joint's), row by row:
/// orders 1, 2, ... one after the other, then as many controls half an order below.
pub(super) fn harmonics(angle: &[f64], ratio: f64) -> Vec<Vec<f64>> {
    let mut columns = vec![vec![0.0; angle.len()]; 4 * ORDERS];
    for (row, angle) in angle.iter().enumerate() {
        let (sin, cos) = (0.5 * ratio * angle).sin_cos();
        let (mut real, mut imaginary) = (1.0, 0.0);
        for half in 1..=2 * ORDERS {
            (real, imaginary) = (real * cos - imaginary * sin, imaginary * cos + real * sin);
            let is_control = half % 2 == 1;
            let first = 2 * ((half - 1) / 2 + ORDERS * usize::from(is_control));
            columns[first][row] = real;
            columns[first + 1][row] = imaginary;
        }
    }
    columns
}
pub(super) fn matrix(
    columns: impl ExactSizeIterator<Item = Vec<f64>>,
    rows: usize,
) -> DMatrix<f64> {
    let count = columns.len();
    let entries: Vec<f64> = columns.flatten().collect();
    DMatrix::from_vec(rows, count, entries)
}

/// A column without the harmonics that its differences of third order show: what is left of a
/// motor's torque is smooth but for noise, while fast cogging would pass for coloured noise.
pub(super) fn without_harmonics(values: &[f64], harmonics: &[Vec<f64>]) -> Vec<f64> {
    let differences = |values: &[f64]| -> Vec<f64> {
        let of = |w: &[f64]| w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0];
        let all = values.windows(4).map(of);
        all.map(|value| if value.is_finite() { value } else { 0.0 })
            .collect()
    };
    let orders = &harmonics[..2 * ORDERS];
    let read = DVector::from_vec(differences(values));
    let differenced = matrix(orders.iter().map(|column| differences(column)), read.len());
    let mut gram = differenced.tr_mul(&differenced);
    // slow harmonics have next to no differences, and are not noise either
    let ridge = 1e-3 * gram.diagonal().max();
    for k in 0..gram.nrows() {
        gram[(k, k)] += ridge;
    }
    let mut rest = DVector::from_column_slice(values);
    if let Some(factor) = gram.cholesky() {
        let amplitudes = factor.solve(&differenced.tr_mul(&read));
        let orders = matrix(orders.iter().cloned(), values.len());
        rest -= orders * amplitudes;
    }
    rest.as_slice().to_vec()
}
