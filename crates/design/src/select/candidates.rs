//! What each candidate would add to a selection.

use haptical_identification::Matrix;
use nalgebra::DMatrix;

use crate::select::change::Change;
use crate::select::gains::eliminate;
use crate::select::whitened::Whitened;

/// G_j = X_j C X_j^T and H_j = X_j K X_j^T of every candidate j, X_j its rows: as of the last [`Candidates::catch_up`].
#[derive(Debug, Clone)]
pub(crate) struct Candidates<'w> {
    rows: &'w Whitened,
    /// G_j, q x q each, one after the other.
    spread: Vec<f64>,
    /// H_j; empty without a weight.
    gained: Vec<f64>,
    /// First entry of each in both.
    place: Vec<usize>,
    behind: Behind,
}

/// What the numbers of the candidates lack.
#[derive(Debug, Clone)]
enum Behind {
    Everything,
    Changes(Vec<Change>),
}

/// Products of all candidates' rows with a change, S = X U and Q = X P, and room for the numbers of one of them.
#[derive(Debug, Clone)]
pub(crate) struct Changed {
    sign: f64,
    seen: Matrix,
    pulled: Option<Matrix>,
    spread: Vec<f64>,
    gained: Vec<f64>,
}

impl<'w> Candidates<'w> {
    pub(crate) fn new(rows: &'w Whitened, has_weight: bool) -> Self {
        let mut place = vec![0];
        for pose in 0..rows.poses() {
            place.push(place[pose] + rows.readings(pose).pow(2));
        }
        let entries = place.last().copied().unwrap_or(0);
        Self {
            rows,
            spread: vec![0.0; entries],
            gained: vec![0.0; if has_weight { entries } else { 0 }],
            place,
            behind: Behind::Everything,
        }
    }

    /// Forgets everything.
    pub(crate) fn forget(&mut self) {
        self.behind = Behind::Everything;
    }

    /// Takes note of a change.
    pub(crate) fn note(&mut self, change: Change) {
        if let Behind::Changes(changes) = &mut self.behind {
            changes.push(change);
        }
    }

    /// Catches up with the covariance C, and with K.
    pub(crate) fn catch_up(&mut self, covariance: &DMatrix<f64>, weighted: &DMatrix<f64>) {
        match std::mem::replace(&mut self.behind, Behind::Changes(Vec::new())) {
            Behind::Changes(changes) => {
                for change in &changes {
                    let mut changed = self.changed(Some(change));
                    for pose in 0..self.rows.poses() {
                        let entries = self.place[pose]..self.place[pose + 1];
                        changed.take(self, pose);
                        self.spread[entries.clone()].copy_from_slice(&changed.spread);
                        if !self.gained.is_empty() {
                            self.gained[entries].copy_from_slice(&changed.gained);
                        }
                    }
                }
            }
            Behind::Everything => {
                squares(self.rows, covariance, &self.place, &mut self.spread);
                if !self.gained.is_empty() {
                    squares(self.rows, weighted, &self.place, &mut self.gained);
                }
            }
        }
    }

    /// What a change does to all candidates: one product with their rows, which is nearly all of the work of a plan.
    pub(crate) fn changed(&self, change: Option<&Change>) -> Changed {
        let product = |moves: &DMatrix<f64>| {
            let mut product = Matrix::zeros(0, 0);
            self.rows.times(moves, &mut product);
            product
        };
        Changed {
            sign: change.map_or(0.0, |change| change.sign),
            seen: change.map_or_else(|| Matrix::zeros(0, 0), |change| product(&change.update)),
            pulled: change.and_then(|change| change.pulled.as_ref().map(product)),
            spread: Vec::new(),
            gained: Vec::new(),
        }
    }

    /// det(I + G), by which det M grows, and trace((I + G)^-1 H), by which trace(W C) falls, with a pose after a change.
    pub(crate) fn gains(&self, changed: &mut Changed, pose: usize) -> (f64, f64) {
        changed.take(self, pose);
        let count = self.rows.readings(pose);
        eliminate(count, &mut changed.spread, &mut changed.gained)
    }

    /// What both are at most: the product of the diagonal of I + G (Hadamard 1893) and the trace of H.
    pub(crate) fn gains_at_most(&self, changed: &Changed, pose: usize) -> (f64, f64) {
        let (mut det, mut trace) = (1.0, 0.0);
        let (count, place) = (self.rows.readings(pose), self.place[pose]);
        for reading in 0..count {
            let (row, entry) = (
                self.rows.first[pose] + reading,
                place + reading * (count + 1),
            );
            let mut spread = self.spread[entry];
            for column in 0..changed.seen.columns() {
                spread -= changed.sign * changed.seen[(row, column)].powi(2);
            }
            det *= 1.0 + spread;
            if let Some(gained) = self.gained.get(entry) {
                trace += gained;
                if let Some(pulled) = &changed.pulled {
                    for column in 0..pulled.columns() {
                        let both = changed.seen[(row, column)] * pulled[(row, column)];
                        trace -= 2.0 * changed.sign * both;
                    }
                }
            }
        }
        (det, trace)
    }
}

/// X_j A X_j^T of every pose.
fn squares(rows: &Whitened, matrix: &DMatrix<f64>, place: &[usize], squares: &mut [f64]) {
    let along = matrix * &rows.rows;
    for pose in 0..rows.poses() {
        let along = along.columns(rows.first[pose], rows.readings(pose));
        let square = rows.pose_rows(pose).tr_mul(&along);
        squares[place[pose]..place[pose + 1]].copy_from_slice(square.as_slice());
    }
}

impl Changed {
    /// The numbers of a pose: G' = G - sign S S^T and H' = H - sign (S Q^T + Q S^T).
    fn take(&mut self, all: &Candidates<'_>, pose: usize) {
        let entries = all.place[pose]..all.place[pose + 1];
        self.spread.clear();
        self.spread.extend_from_slice(&all.spread[entries.clone()]);
        self.gained.clear();
        if !all.gained.is_empty() {
            self.gained.extend_from_slice(&all.gained[entries]);
        }
        let readings = all.rows.first[pose]..all.rows.first[pose + 1];
        let count = readings.len();
        if count == 0 {
            return;
        }
        for column in 0..self.seen.columns() {
            let seen = &self.seen.column(column)[readings.clone()];
            for (right, column) in seen.iter().zip(self.spread.chunks_exact_mut(count)) {
                let factor = self.sign * right;
                let entries = column.iter_mut().zip(seen);
                entries.for_each(|(entry, left)| *entry -= factor * left);
            }
        }
        let Some(pulled) = &self.pulled else {
            return;
        };
        for column in 0..self.seen.columns() {
            let seen = &self.seen.column(column)[readings.clone()];
            let pulled = &pulled.column(column)[readings.clone()];
            let columns = self.gained.chunks_exact_mut(count);
            for ((seen_b, pulled_b), column) in seen.iter().zip(pulled).zip(columns) {
                let entries = column.iter_mut().zip(seen.iter().zip(pulled));
                entries.for_each(|(entry, (seen_a, pulled_a))| {
                    *entry -= self.sign * (seen_a * pulled_b + pulled_a * seen_b);
                });
            }
        }
    }
}

#[cfg(test)]
impl Candidates<'_> {
    /// All of G and H.
    pub(crate) fn numbers(&self) -> (&[f64], &[f64]) {
        (&self.spread, &self.gained)
    }
}
