//! Residuals at rows that a linear fit did not see: each segment of the recording is left out once
//! (docs/diagnosis.md, "Partial causes").

use haptical_effects::Context;
use haptical_judge::{Gain, closed_share};
use haptical_linalg::Direction;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::engine::System;
use crate::thresholds::partial::{RIDGE, SEGMENTS};

/// The segments of a recording, with what its base model has in each.
#[derive(Debug)]
pub(crate) struct Segments {
    segments: Vec<Segment>,
    /// Directions of the base model.
    base: usize,
}

#[derive(Debug)]
struct Segment {
    /// Entries of the whitened vectors.
    entries: Vec<usize>,
    /// The base model's directions at these entries, as columns and as rows.
    base: DMatrix<f64>,
    across: DMatrix<f64>,
    /// What the other segments have of each direction, decomposed; none where some have nothing.
    others: Option<Cholesky<f64, Dyn>>,
}

/// Squared residual of every segment, as the other segments predict it.
#[derive(Debug, Clone)]
pub(crate) struct Unseen(Vec<f64>);

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
        let segments = entries.into_iter();
        Self {
            segments: segments
                .map(|entries| Segment::new(entries, &system.basis, RIDGE))
                .collect(),
            base: system.basis.len(),
        }
    }

    /// What a system has in addition to the base model.
    pub(crate) fn added<'s>(&self, system: &'s System) -> &'s [Direction] {
        &system.basis[self.base..]
    }

    /// What a system leaves where its segment was left out of the fit.
    ///
    /// With B the orthonormal directions of the fit, B_s their rows in segment s, and e the residual of the fit to
    /// all, that of the fit without s is e_s + B_s (I - B_s^T B_s)^-1 B_s^T e_s (the update of Sherman, Morrison &
    /// Woodbury; Cook & Weisberg 1982, 2.2).
    pub(crate) fn unseen(&self, system: &System) -> Unseen {
        self.unseen_with(&system.residual, self.added(system))
    }

    /// The same of a residual and of the directions that a fit has in addition to the base model's.
    pub(crate) fn unseen_with(&self, residual: &[f64], added: &[Direction]) -> Unseen {
        let squares = self.segments.iter().map(|segment| {
            let entries = &segment.entries;
            let own = entries.iter().map(|&entry| residual[entry]);
            let own = DVector::from_iterator(entries.len(), own);
            let added = directions_at(entries, added);
            segment.predicted(own, &added, RIDGE).norm_squared()
        });
        Unseen(squares.collect())
    }
}

impl Unseen {
    /// What it gains on another one, segment by segment.
    pub(crate) fn gain_on(&self, other: &Self) -> Gain {
        Gain::between(&other.0, &self.0)
    }

    /// Share of the squares beyond noise that `before` leaves and this does not.
    pub(crate) fn closed_of(&self, before: &Self, noise: f64) -> f64 {
        let closed = closed_share(&before.0, &self.0, noise);
        closed.share.clamp(0.0, 1.0)
    }

    /// Over all segments.
    pub(crate) fn sum(&self) -> f64 {
        self.0.iter().sum()
    }
}

impl Segment {
    fn new(entries: Vec<usize>, directions: &[Direction], ridge: f64) -> Self {
        let base = directions_at(&entries, directions);
        let across = base.transpose();
        let others = DMatrix::identity(base.ncols(), base.ncols()) * (1.0 + ridge);
        Self {
            others: (others - &across * &base).cholesky(),
            entries,
            base,
            across,
        }
    }

    /// The residual as the fit to the other segments has it, from that of the fit to all; `added` are the directions of
    /// the fit here besides the base model's. The base model's part of I - B_s^T B_s is decomposed once; its Schur
    /// complement is that of the others (Golub & Van Loan 2013, section 4.2).
    fn predicted(&self, residual: DVector<f64>, added: &DMatrix<f64>, ridge: f64) -> DVector<f64> {
        let (base, added_rows) = (&self.base, added.transpose());
        let (of_base, of_added) = (&self.across * &residual, &added_rows * &residual);
        let solved = self.others.as_ref().and_then(|others| {
            let lower = others.l_dirty();
            let shared = lower.solve_lower_triangular(&(&self.across * added))?;
            let known = lower.solve_lower_triangular(&of_base)?;
            let count = added.ncols();
            let own = DMatrix::identity(count, count) * (1.0 + ridge) - &added_rows * added;
            let own = (own - shared.tr_mul(&shared)).cholesky()?;
            let by_added = own.solve(&(&of_added + shared.tr_mul(&known)));
            let by_base = lower.tr_solve_lower_triangular(&(known + &shared * &by_added))?;
            Some((by_base, by_added))
        });
        let (by_base, by_added) = solved.unwrap_or((of_base, of_added));
        residual + base * by_base + added * by_added
    }
}

fn directions_at(entries: &[usize], directions: &[Direction]) -> DMatrix<f64> {
    DMatrix::from_fn(entries.len(), directions.len(), |row, column| {
        directions[column].entry(entries[row])
    })
}

#[cfg(test)]
mod tests {
    use haptical_linalg::Direction;
    use nalgebra::{DMatrix, DVector};

    use super::Segment;

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
            let residual = residual.rows(segment.start, length).into_owned();
            // whichever of the directions are the base model's
            for known in 0..=3 {
                let at = basis.rows(segment.start, length);
                let directions = (0..known)
                    .map(|column| Direction::new(basis.column(column).iter().copied().collect()));
                let entries = segment.clone().collect();
                let own = Segment::new(entries, &directions.collect::<Vec<_>>(), 0.0);
                let added = at.columns_range(known..).into_owned();
                let predicted = own.predicted(residual.clone(), &added, 0.0);
                assert!((predicted - &unseen).norm() < 1e-9, "{known}");
            }
        }
    }
}
