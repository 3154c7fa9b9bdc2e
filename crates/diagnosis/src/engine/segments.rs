//! Residuals at rows that a linear fit did not see: each segment of the recording is left out once
//! (docs/diagnosis.md, "Partial causes").

use haptical_effects::Context;
use haptical_linalg::Direction;
use nalgebra::{DMatrix, DVector};

use crate::engine::system::System;
use crate::thresholds::partial::{RIDGE, SEGMENTS};

/// The segments of a recording, with what its base model has in each.
#[derive(Debug)]
pub(crate) struct Segments {
    /// Entries of the whitened vectors.
    entries: Vec<Vec<usize>>,
    /// The base model's directions at these entries.
    base: Vec<DMatrix<f64>>,
    /// Products of these directions with each other.
    own: Vec<DMatrix<f64>>,
}

/// Squared residual of every segment, as the other segments predict it.
#[derive(Debug, Clone)]
pub(crate) struct Unseen(Vec<f64>);

/// A sum over segments with its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Gain {
    pub(crate) sum: f64,
    pub(crate) sd: f64,
}

impl Segments {
    /// Contiguous parts of the rows, with all streams of each.
    pub(crate) fn new(context: &Context<'_>, system: &System) -> Self {
        let rows = context.rows().max(1);
        let count = SEGMENTS.min(rows / 2).max(2);
        let mut entries = vec![Vec::new(); count];
        for stream in 0..context.streams.len() {
            for (block, entry) in system.layout.range(stream).enumerate() {
                let row = system.layout.row(stream, block);
                entries[(row * count / rows).min(count - 1)].push(entry);
            }
        }
        entries.retain(|segment| !segment.is_empty());
        let base: Vec<DMatrix<f64>> = entries
            .iter()
            .map(|segment| directions_at(segment, &system.basis))
            .collect();
        let own = base.iter().map(|at| at.tr_mul(at)).collect();
        Self { entries, base, own }
    }

    /// What a system leaves where its segment was left out of the fit.
    ///
    /// With B the orthonormal directions of the fit, B_s their rows in segment s, and e the residual of the fit to
    /// all, that of the fit without s is e_s + B_s (I - B_s^T B_s)^-1 B_s^T e_s (the update of Sherman, Morrison &
    /// Woodbury; Cook & Weisberg 1982, 2.2).
    pub(crate) fn unseen(&self, system: &System) -> Unseen {
        let more = &system.basis[self.base.first().map_or(0, DMatrix::ncols)..];
        let squares = (0..self.entries.len()).map(|segment| {
            let entries = &self.entries[segment];
            let residual = DVector::from_iterator(
                entries.len(),
                entries.iter().map(|&entry| system.residual[entry]),
            );
            let (base, own) = (&self.base[segment], &self.own[segment]);
            let new = directions_at(entries, more);
            predicted_by_others(residual, base, own, &new, RIDGE).norm_squared()
        });
        Unseen(squares.collect())
    }
}

impl Gain {
    /// The sum over its scatter.
    pub(crate) fn deviations(self) -> f64 {
        self.sum / self.sd.max(f64::MIN_POSITIVE)
    }
}

impl Unseen {
    /// What it gains on another one, with the scatter of the segments (jackknife).
    pub(crate) fn gain_on(&self, other: &Self) -> Gain {
        let gains: Vec<f64> = other.0.iter().zip(&self.0).map(|(a, b)| a - b).collect();
        let count = gains.len() as f64;
        let sum: f64 = gains.iter().sum();
        let scatter: f64 = gains.iter().map(|gain| (gain - sum / count).powi(2)).sum();
        Gain {
            sum,
            sd: (scatter * count / (count - 1.0).max(1.0)).sqrt(),
        }
    }

    /// How surely it gains on another one, in standard deviations: by the sizes of the segments' gains, or by how many gain at
    /// all (the sign test), whichever is surer. A few segments that a fit extrapolates to badly scatter the sizes.
    pub(crate) fn surely_gains_on(&self, other: &Self) -> f64 {
        let count = self.0.len() as f64;
        let pairs = self.0.iter().zip(&other.0);
        let gaining = pairs.filter(|(own, other)| own < other).count() as f64;
        let by_sign = (2.0 * gaining - count) / count.sqrt();
        let gain = self.gain_on(other);
        if gain.sum > 0.0 {
            gain.deviations().max(by_sign)
        } else {
            gain.deviations()
        }
    }

    /// Over all segments.
    pub(crate) fn sum(&self) -> f64 {
        self.0.iter().sum()
    }
}

/// The residual of a segment as the fit to the others has it, from that of the fit to all; `base` and `new` are the
/// orthonormal directions of the fit at the segment, `own` the products of the first with each other.
fn predicted_by_others(
    residual: DVector<f64>,
    base: &DMatrix<f64>,
    own: &DMatrix<f64>,
    new: &DMatrix<f64>,
    ridge: f64,
) -> DVector<f64> {
    let (known, all) = (base.ncols(), base.ncols() + new.ncols());
    let mut normal = DMatrix::zeros(all, all);
    normal.view_mut((0, 0), (known, known)).copy_from(own);
    let across = base.tr_mul(new);
    normal
        .view_mut((known, 0), (new.ncols(), known))
        .copy_from(&across.transpose());
    normal
        .view_mut((0, known), (known, new.ncols()))
        .copy_from(&across);
    normal
        .view_mut((known, known), (new.ncols(), new.ncols()))
        .copy_from(&new.tr_mul(new));
    let left = DMatrix::identity(all, all) * (1.0 + ridge) - normal;
    let mut seen = DVector::zeros(all);
    seen.rows_mut(0, known).copy_from(&base.tr_mul(&residual));
    seen.rows_mut(known, new.ncols())
        .copy_from(&new.tr_mul(&residual));
    let moved = match left.cholesky() {
        Some(factor) => factor.solve(&seen),
        None => seen,
    };
    residual + base * moved.rows(0, known) + new * moved.rows(known, all - known)
}

fn directions_at(entries: &[usize], directions: &[Direction]) -> DMatrix<f64> {
    DMatrix::from_fn(entries.len(), directions.len(), |row, column| {
        directions[column].entry(entries[row])
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::predicted_by_others;

    /// Against fits to the other rows by the normal equations.
    #[test]
    fn a_segment_is_predicted_as_if_it_had_not_been_fitted() {
        let rows = 40;
        let design = DMatrix::from_fn(rows, 3, |row, column| {
            (0.37 * row as f64 * (column + 1) as f64).sin() + 0.01 * (row * column) as f64
        });
        let reading = DVector::from_fn(rows, |row, _| (1.7 * row as f64).cos());
        let basis = design.clone().qr().q();
        let residual = &reading - &basis * basis.tr_mul(&reading);
        for segment in [0..8, 8..16, 33..40] {
            let others: Vec<usize> = (0..rows).filter(|row| !segment.contains(row)).collect();
            let seen = design.select_rows(&others);
            let normal = seen.tr_mul(&seen).cholesky().unwrap();
            let fitted = normal.solve(&seen.tr_mul(&reading.select_rows(&others)));
            let length = segment.len();
            let unseen =
                reading.rows(segment.start, length) - design.rows(segment.start, length) * fitted;
            let at = basis.rows(segment.start, length).into_owned();
            let predicted = predicted_by_others(
                residual.rows(segment.start, length).into_owned(),
                &at,
                &at.tr_mul(&at),
                &DMatrix::zeros(length, 0),
                0.0,
            );
            assert!((predicted - unseen).norm() < 1e-9);
        }
    }
}
