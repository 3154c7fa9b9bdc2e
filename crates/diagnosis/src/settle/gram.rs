//! Products of all columns of a recording, which add from recording to recording, and the odds that they give.

use haptical_linalg::{Matrix, NormalEquations};
use nalgebra::DMatrix;

use crate::thresholds::settle::RIDGE;

/// Places of the columns: the base model's and those beside it first, then candidate by candidate its signal and its slopes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Places {
    /// Columns that every candidate may use.
    pub(super) common: usize,
    pub(super) slopes: Vec<usize>,
}

impl Places {
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
    /// Log-odds of its being named after the recording, hedged as the judge of a diagnosis hedges \[nats\].
    pub nats_after: f64,
}

/// What recordings tell of a candidate that is true, in nats.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Told {
    /// Half the squared part of its signal that neither the common columns nor the other one's slopes can imitate.
    pub(super) distance: f64,
    /// Half the squared part that the common columns alone cannot imitate.
    pub(super) whole: f64,
}

impl Told {
    /// Share of what it explains that the other one would explain in its place.
    pub(super) fn imitated(self) -> f64 {
        match self.whole > 0.0 {
            true => (1.0 - self.distance / self.whole).clamp(0.0, 1.0),
            false => 1.0,
        }
    }
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
pub(super) struct Gram {
    products: DMatrix<f64>,
    /// Windows in which the judge compares what is left with noise.
    pub(super) windows: f64,
}

impl Gram {
    /// Of columns of equal length, over so many windows.
    pub(super) fn new(columns: &[Vec<f64>], windows: f64) -> Self {
        let rows = columns.first().map_or(0, Vec::len);
        let all = DMatrix::from_fn(rows, columns.len(), |row, column| columns[column][row]);
        Self {
            products: all.tr_mul(&all),
            windows,
        }
    }

    pub(super) fn zero(count: usize) -> Self {
        Self {
            products: DMatrix::zeros(count, count),
            windows: 0.0,
        }
    }

    /// Both recordings together.
    pub(super) fn plus(&self, other: &Self) -> Self {
        let mut both = self.clone();
        both.add(other);
        both
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.products += &other.products;
        self.windows += other.windows;
    }

    /// What is known of a column's number beforehand: one over its standard deviation.
    pub(super) fn stiffen(&mut self, column: usize, stiffness: f64) {
        self.products[(column, column)] += stiffness * stiffness;
    }

    /// For every ordered pair (A, B) what there is of A's signal, and what neither the common columns nor B's slopes imitate.
    pub(super) fn told(&self, places: &Places) -> Vec<Told> {
        let left = self.without_common(places);
        let first = places.common;
        let pairs = places.pairs().map(|(a, b)| {
            let (signal, slope) = (places.signal(a) - first, places.signal(b) + 1 - first);
            let whole = left[(signal, signal)].max(0.0);
            let count = places.slopes[b];
            let told = |imitated: f64| Told {
                distance: 0.5 * (whole - imitated).max(0.0),
                whole: 0.5 * whole,
            };
            if count == 0 {
                return told(0.0);
            }
            let place = |i: usize| if i == count { signal } else { slope + i };
            let sums = NormalEquations::from_products(count, |i, j| left[(place(i), place(j))]);
            let slopes: Vec<usize> = (0..count).collect();
            let ridge = |i: usize| {
                let column = first + slope + i;
                RIDGE * self.products[(column, column)] + 1e-300
            };
            told(sums.solve(&slopes, ridge).explained())
        });
        pairs.collect()
    }

    /// Products of the candidates' columns across the common ones.
    fn without_common(&self, places: &Places) -> Matrix {
        let (first, count) = (places.common, places.count());
        let sums = NormalEquations::from_products(count, |a, b| match a < count {
            true => self.products[(a, b)],
            false => 0.0,
        });
        let common: Vec<usize> = (0..first).collect();
        let fit = sums.solve(&common, |column| RIDGE * sums.product(column, column));
        sums.across(&fit, &(first..count).collect::<Vec<_>>())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

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
        let whole = Gram::new(&half(0), 5.0).plus(&Gram::new(&half(20), 5.0));
        let told = whole.told(&places);
        let found: Vec<f64> = told.iter().map(|told| told.distance).collect();
        for (found, (a, b)) in found.iter().zip(places.pairs()) {
            let others: Vec<Vec<f64>> = common.iter().chain(&slopes[b]).cloned().collect();
            let expected = by_projection(&signals[a], &others);
            assert!(
                (found - expected).abs() < 1e-6 * expected,
                "{a} {b}: {found} {expected}"
            );
        }
        assert!(found.iter().all(|nats| *nats > 0.1), "{found:?}");
        // without the other's slopes there is more
        let alone = by_projection(&signals[0], &common);
        assert!((told[0].whole - alone).abs() < 1e-6 * alone && told[0].imitated() > 0.0);
        assert!(told.iter().all(|told| told.imitated() < 1.0), "{told:?}");
    }

    #[test]
    fn what_the_other_can_imitate_has_no_distance() {
        let own: Vec<f64> = (0..30).map(|row| f64::from(row).sin()).collect();
        let twice: Vec<f64> = own.iter().map(|value| 2.0 * value).collect();
        let places = Places {
            common: 0,
            slopes: vec![1, 1],
        };
        let gram = Gram::new(&[own.clone(), own.clone(), twice.clone(), own], 1.0);
        let told = gram.told(&places);
        assert!(
            told.iter()
                .all(|told| told.distance < 1e-6 && told.imitated() > 1.0 - 1e-6)
        );
    }
}
