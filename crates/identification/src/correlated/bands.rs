//! A signal's rows by frequency: the discrete cosine transform in a few bands.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::cosines::Cosines;
use super::group::Group;
use super::problem::Signal;
use super::rows::along;

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
    pub(super) fn new(
        signal: &Signal,
        (group, places): (&Group, &Range<usize>),
        sizes: &[f64],
        is_long: bool,
    ) -> Self {
        let (count, columns) = (places.len(), group.basis.ncols());
        let held = group.held.ncols();
        let sizes = &sizes[places.clone()];
        let basis = group.basis.column_iter();
        let basis = basis.map(|column| column.rows_range(places.clone()).into_owned());
        let line = DVector::from_fn(count, |place, _| along(place, count));
        let readings = DVector::from_column_slice(&group.readings[places.clone()]);
        let others = group.held.column_iter();
        let others = others.map(|column| column.rows_range(places.clone()).into_owned());
        let mut table = DMatrix::zeros(count, columns + 2 + held);
        let all = basis.chain([line, readings]).chain(others);
        for (mut into, from) in table.column_iter_mut().zip(all) {
            for ((entry, value), size) in into.iter_mut().zip(from.iter()).zip(sizes) {
                *entry = value / size;
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
        // from the group's coordinates to those of the whole
        let parameters = group.coordinates.ncols();
        let mut way = DMatrix::zeros(columns + 2 + held, parameters + 2 + held);
        way.view_mut((0, 0), (columns, parameters))
            .copy_from(&group.coordinates);
        for k in 0..2 + held {
            way[(columns + k, parameters + k)] = 1.0;
        }
        let of_band = |pair: &[usize]| {
            let modes = table.rows(pair[0], pair[1] - pair[0]);
            way.tr_mul(&(modes.transpose() * modes * &way))
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
