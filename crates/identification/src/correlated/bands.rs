//! A signal's rows by frequency: the discrete cosine transform in a few bands.

use nalgebra::DMatrix;

use super::cosines::Cosines;
use super::problem::Signal;
use super::rows::{Rows, along};

/// Products of a signal's columns in bands of frequency. Columns: those of the basis, a line in time, the readings, held
/// parameters; all over the local size of the noise.
pub(super) struct SignalBands {
    pub(super) grams: Vec<DMatrix<f64>>,
    /// Modes of each band.
    pub(super) modes: Vec<f64>,
    /// Whether it may have a line in time: it is long enough, and no parameter is its drift.
    pub(super) may_have_line: bool,
}

/// Modes of the first band, and the ratio of the ends of the others.
const FIRST: usize = 4;
const RATIO: f64 = 1.8;

impl SignalBands {
    pub(super) fn new(signal: &Signal, rows: &Rows, sizes: &[f64], is_long: bool) -> Self {
        let (count, columns) = (signal.rows.len(), rows.basis.ncols());
        let held = rows.held.ncols();
        let mut table = DMatrix::zeros(count, columns + 2 + held);
        for column in 0..columns {
            let own = rows.basis.column(column);
            for (entry, &row) in table.column_mut(column).iter_mut().zip(&signal.rows) {
                *entry = own[row] / sizes[row];
            }
        }
        for (place, &row) in signal.rows.iter().enumerate() {
            table[(place, columns)] = along(place, count) / sizes[row];
            table[(place, columns + 1)] = rows.readings[row] / sizes[row];
            for column in 0..held {
                table[(place, columns + 2 + column)] = rows.held[(row, column)] / sizes[row];
            }
        }
        let bounds = match is_long {
            true => bounds(count),
            false => vec![0, count],
        };
        if is_long {
            let mut transform = Cosines::new(count);
            for mut column in table.column_iter_mut() {
                transform.apply(column.as_mut_slice());
            }
        }
        let of_band = |pair: &[usize]| {
            let own = table.rows(pair[0], pair[1] - pair[0]);
            own.transpose() * own
        };
        Self {
            grams: bounds.windows(2).map(of_band).collect(),
            modes: bounds
                .windows(2)
                .map(|pair| (pair[1] - pair[0]) as f64)
                .collect(),
            may_have_line: is_long && !signal.has_drift,
        }
    }
}

/// Ends of the bands of modes 0 to `count`.
fn bounds(count: usize) -> Vec<usize> {
    let mut bounds = vec![0, FIRST.min(count)];
    let mut last = FIRST;
    while last < count {
        last = ((last as f64 * RATIO) as usize + 1).min(count);
        bounds.push(last);
    }
    bounds
}
