//! Products of all columns of a recording, which add from recording to recording, and the odds that they give.

use nalgebra::{Cholesky, DMatrix, DVector};

/// What keeps directions that no row shows from being divided by: a share of a column's squared length.
const RIDGE: f64 = 1e-9;

/// Places of the columns: the base model's and those beside it first, then candidate by candidate its signal and its slopes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Places {
    /// Columns that every candidate may use.
    pub(super) common: usize,
    /// Slopes of each candidate.
    pub(super) slopes: Vec<usize>,
}

impl Places {
    /// Columns in all.
    pub(super) fn count(&self) -> usize {
        self.common + self.slopes.iter().map(|own| own + 1).sum::<usize>()
    }

    /// Column of a candidate's signal; its slopes follow.
    pub(super) fn signal(&self, candidate: usize) -> usize {
        let before = &self.slopes[..candidate];
        self.common + before.iter().map(|own| own + 1).sum::<usize>()
    }

    /// Ordered pairs of candidates.
    pub(super) fn pairs(&self) -> impl Iterator<Item = (usize, usize)> {
        let count = self.slopes.len();
        (0..count).flat_map(move |a| (0..count).filter(move |&b| b != a).map(move |b| (a, b)))
    }
}

/// Expected log-odds of a candidate that is true over another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Odds {
    /// Position of the candidate that is taken to be true.
    pub is_true: usize,
    /// The other one.
    pub other: usize,
    /// Log-odds of the true one so far \[nats\].
    pub nats_before: f64,
    /// Mean of those after the recording \[nats\]; their variance is twice what the recording adds.
    pub nats_after: f64,
}

impl Odds {
    /// What the recording adds \[nats\].
    pub fn gained_nats(&self) -> f64 {
        self.nats_after - self.nats_before
    }

    /// Least log-odds to expect \[nats\] of all pairs but those that nothing tells apart, whichever candidate is true; none
    /// where no pair is left.
    pub fn least_nats(all: &[Self], inseparable: &[(usize, usize)]) -> Option<f64> {
        let told = all.iter().filter(|own| own.is_told(inseparable));
        told.map(|own| own.nats_after).reduce(f64::min)
    }

    /// Whether its pair is none of those that nothing tells apart.
    pub(super) fn is_told(&self, inseparable: &[(usize, usize)]) -> bool {
        !inseparable.contains(&(self.is_true, self.other))
    }
}

/// Products of whitened columns.
#[derive(Debug, Clone)]
pub(super) struct Gram(DMatrix<f64>);

impl Gram {
    /// Of columns of equal length.
    pub(super) fn new(columns: &[Vec<f64>]) -> Self {
        let rows = columns.first().map_or(0, Vec::len);
        let all = DMatrix::from_fn(rows, columns.len(), |row, column| columns[column][row]);
        Self(all.tr_mul(&all))
    }

    pub(super) fn zero(count: usize) -> Self {
        Self(DMatrix::zeros(count, count))
    }

    /// Both recordings together.
    pub(super) fn plus(&self, other: &Self) -> Self {
        Self(&self.0 + &other.0)
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.0 += &other.0;
    }

    /// What is known of a column's number beforehand: one over its standard deviation.
    pub(super) fn stiffen(&mut self, column: usize, stiffness: f64) {
        self.0[(column, column)] += stiffness * stiffness;
    }

    /// For every ordered pair (A, B) half the squared part of A's signal that neither the common columns nor B's slopes can
    /// imitate, in nats.
    pub(super) fn distances(&self, places: &Places) -> Vec<f64> {
        let left = self.without_common(places);
        let first = places.common;
        let pairs = places.pairs().map(|(a, b)| {
            let (signal, slope) = (places.signal(a) - first, places.signal(b) + 1 - first);
            let whole = left[(signal, signal)];
            let count = places.slopes[b];
            if count == 0 {
                return 0.5 * whole.max(0.0);
            }
            let mut own = DMatrix::from_fn(count, count, |i, j| left[(slope + i, slope + j)]);
            let along = DVector::from_fn(count, |i, _| left[(slope + i, signal)]);
            for i in 0..count {
                own[(i, i)] += RIDGE * self.0[(first + slope + i, first + slope + i)] + 1e-300;
            }
            let imitated = Cholesky::new(own).map_or(0.0, |own| along.dot(&own.solve(&along)));
            0.5 * (whole - imitated).max(0.0)
        });
        pairs.collect()
    }

    /// Products of the candidates' columns across the common ones.
    fn without_common(&self, places: &Places) -> DMatrix<f64> {
        let (first, count) = (places.common, places.count());
        let rest = self.0.view((first, first), (count - first, count - first));
        let rest = rest.into_owned();
        if first == 0 {
            return rest;
        }
        // scaled, so that a length and an angle have the same say
        let scale = DVector::from_fn(first, |i, _| 1.0 / self.0[(i, i)].max(1e-300).sqrt());
        let mut common =
            DMatrix::from_fn(first, first, |i, j| self.0[(i, j)] * scale[i] * scale[j]);
        for i in 0..first {
            common[(i, i)] += RIDGE;
        }
        let across = DMatrix::from_fn(first, count - first, |i, j| {
            self.0[(i, first + j)] * scale[i]
        });
        match Cholesky::new(common) {
            Some(common) => rest - across.tr_mul(&common.solve(&across)),
            None => rest,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Least squares by QR of nalgebra: another way to the same distance.
    fn by_projection(signal: &[f64], others: &[Vec<f64>]) -> f64 {
        let rows = signal.len();
        let matrix = DMatrix::from_fn(rows, others.len(), |row, column| others[column][row]);
        let q = matrix.qr().q();
        let signal = DVector::from_column_slice(signal);
        let left = &signal - &q * (q.transpose() * &signal);
        0.5 * left.norm_squared()
    }

    #[test]
    fn distances_are_half_the_squares_that_projections_leave() {
        let column = |seed: f64| -> Vec<f64> {
            let rows = (0..40).map(f64::from);
            rows.map(|row| (seed * row * row + row).sin() + 0.1 * seed)
                .collect()
        };
        let common = [column(0.3), column(1.7)];
        let signals = [column(2.3), column(0.9)];
        let slopes = [vec![column(0.4), column(5.1)], vec![column(0.71)]];
        let places = Places {
            common: 2,
            slopes: vec![2, 1],
        };
        let mut all = common.to_vec();
        for (signal, slopes) in signals.iter().zip(&slopes) {
            all.push(signal.clone());
            all.extend(slopes.iter().cloned());
        }
        assert_eq!(places.count(), all.len());
        // two recordings of half the rows each have the same products together
        let half = |from: usize| -> Vec<Vec<f64>> {
            all.iter()
                .map(|column| column[from..from + 20].to_vec())
                .collect()
        };
        let whole = Gram::new(&half(0)).plus(&Gram::new(&half(20)));
        let found = whole.distances(&places);
        for (found, (a, b)) in found.iter().zip(places.pairs()) {
            let others: Vec<Vec<f64>> = common.iter().chain(&slopes[b]).cloned().collect();
            let expected = by_projection(&signals[a], &others);
            assert!(
                (found - expected).abs() < 1e-6 * expected,
                "{a} {b}: {found} {expected}"
            );
        }
        assert!(found.iter().all(|nats| *nats > 0.1), "{found:?}");
    }

    #[test]
    fn what_the_other_can_imitate_has_no_distance() {
        let own: Vec<f64> = (0..30).map(|row| f64::from(row).sin()).collect();
        let twice: Vec<f64> = own.iter().map(|value| 2.0 * value).collect();
        let places = Places {
            common: 0,
            slopes: vec![1, 1],
        };
        let gram = Gram::new(&[own.clone(), own.clone(), twice.clone(), own]);
        assert!(gram.distances(&places).iter().all(|nats| *nats < 1e-6));
    }
}
