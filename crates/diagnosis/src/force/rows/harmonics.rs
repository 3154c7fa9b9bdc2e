//! Cosines and sines of multiples of a motor's angle.

use haptical_effects::force::COGGING_ORDERS;
use nalgebra::{DMatrix, DVector};

use crate::engine::system::dot;

/// Highest order of cogging that is tried.
pub(crate) const ORDERS: usize = COGGING_ORDERS;

/// Cosines and sines of multiples of the motor's angle (`ratio` times the joint's), row by row:
/// orders 1, 2, ... one after the other, then as many controls half an order below.
pub(crate) fn harmonics(angle: &[f64], ratio: f64) -> Vec<Vec<f64>> {
    let mut columns = vec![vec![0.0; angle.len()]; 4 * ORDERS];
    for (row, angle) in angle.iter().enumerate() {
        let (sin, cos) = (0.5 * ratio * angle).sin_cos();
        let (mut real, mut imaginary) = (1.0, 0.0);
        for half in 1..=2 * ORDERS {
            (real, imaginary) = (real * cos - imaginary * sin, imaginary * cos + real * sin);
            let order = (half - 1) / 2;
            let first = if half % 2 == 0 {
                2 * order
            } else {
                2 * (ORDERS + order)
            };
            columns[first][row] = real;
            columns[first + 1][row] = imaginary;
        }
    }
    columns
}

/// A column without the harmonics that its differences of third order show: what is left of a
/// motor's torque is smooth but for noise, while fast cogging would pass for coloured noise.
pub(crate) fn without_harmonics(values: &[f64], harmonics: &[Vec<f64>]) -> Vec<f64> {
    let differences = |values: &[f64]| -> Vec<f64> {
        let of = |w: &[f64]| w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0];
        let all = values.windows(4).map(of);
        all.map(|value| if value.is_finite() { value } else { 0.0 })
            .collect()
    };
    let orders = &harmonics[..2 * ORDERS];
    let own: Vec<Vec<f64>> = orders.iter().map(|column| differences(column)).collect();
    let read = differences(values);
    let right = DVector::from_iterator(own.len(), own.iter().map(|column| dot(column, &read)));
    let mut gram = DMatrix::from_fn(own.len(), own.len(), |a, b| dot(&own[a], &own[b]));
    // slow harmonics have next to no differences, and are not noise either
    let ridge = 1e-3 * gram.diagonal().max();
    for k in 0..own.len() {
        gram[(k, k)] += ridge;
    }
    let mut rest = values.to_vec();
    if let Some(factor) = gram.cholesky() {
        let amplitudes = factor.solve(&right);
        for (column, amplitude) in orders.iter().zip(amplitudes.iter()) {
            for (rest, value) in rest.iter_mut().zip(column) {
                *rest -= amplitude * value;
            }
        }
    }
    rest
}
