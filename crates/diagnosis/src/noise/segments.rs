//! Segments of a motion: what a cubic leaves of them, and the moments of that.

use crate::thresholds::noise::{DISTURBED, LAGS, SEGMENT_ROWS};

/// Orthonormal polynomials up to the third degree on a segment.
pub(super) fn segment_basis() -> [[f64; SEGMENT_ROWS]; 4] {
    let mut basis = [[0.0; SEGMENT_ROWS]; 4];
    for degree in 0..4 {
        let mut vector = [0.0; SEGMENT_ROWS];
        for (index, entry) in vector.iter_mut().enumerate() {
            let place = (index as f64 - 7.5) / 7.5;
            *entry = place.powi(degree as i32);
        }
        without(&mut vector, &basis[..degree]);
        let norm = vector.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
        vector.iter_mut().for_each(|entry| *entry /= norm);
        basis[degree] = vector;
    }
    basis
}

/// Takes the parts along orthonormal polynomials off a segment.
fn without(part: &mut [f64; SEGMENT_ROWS], basis: &[[f64; SEGMENT_ROWS]]) {
    for polynomial in basis {
        let shared: f64 = part.iter().zip(polynomial).map(|(a, b)| a * b).sum();
        for (entry, other) in part.iter_mut().zip(polynomial) {
            *entry -= shared * other;
        }
    }
}

/// Sums of products of rows at lags 0, 1, ... of what a cubic leaves.
pub(super) fn segment_moments(part: &[f64], basis: &[[f64; SEGMENT_ROWS]; 4]) -> [f64; LAGS] {
    let mut rest = [0.0; SEGMENT_ROWS];
    rest.copy_from_slice(part);
    without(&mut rest, basis);
    let mut moments = [0.0; LAGS];
    for (lag, moment) in moments.iter_mut().enumerate() {
        *moment = (lag..SEGMENT_ROWS)
            .map(|row| rest[row] * rest[row - lag])
            .sum();
    }
    moments
}

/// Expected moments of a segment of a first-order autoregression of unit variance.
pub(super) fn expected_moments(colour: f64, basis: &[[f64; SEGMENT_ROWS]; 4]) -> [f64; LAGS] {
    // M C M, M the projection that takes the cubic out: columns first, then rows
    let powers: [f64; SEGMENT_ROWS] = std::array::from_fn(|lag| colour.powi(lag as i32));
    let mut projected = [[0.0; SEGMENT_ROWS]; SEGMENT_ROWS];
    for (column, entries) in projected.iter_mut().enumerate() {
        for (row, entry) in entries.iter_mut().enumerate() {
            *entry = powers[row.abs_diff(column)];
        }
        without(entries, basis);
    }
    let mut both = [[0.0; SEGMENT_ROWS]; SEGMENT_ROWS];
    for row in 0..SEGMENT_ROWS {
        for column in 0..SEGMENT_ROWS {
            both[row][column] = projected[column][row];
        }
        without(&mut both[row], basis);
    }
    let mut moments = [0.0; LAGS];
    for (lag, moment) in moments.iter_mut().enumerate() {
        *moment = (lag..SEGMENT_ROWS)
            .map(|index| both[index - lag][index])
            .sum();
    }
    moments
}

/// Leaves the segments that nothing disturbs, the quietest first.
pub(super) fn leave_undisturbed<T>(segments: &mut Vec<T>, square: impl Fn(&T) -> f64) {
    segments.sort_by(|a, b| square(a).total_cmp(&square(b)));
    let limit = DISTURBED * square(&segments[segments.len() / 2]);
    segments.retain(|segment| square(segment) <= limit);
}
