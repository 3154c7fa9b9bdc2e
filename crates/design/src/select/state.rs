//! The information of a selection of poses, kept up to date while poses come and go.

use nalgebra::{Cholesky, DMatrix};

use crate::select::candidates::Candidates;
use crate::select::change::Change;
use crate::select::whitened::Whitened;

/// Covariance C of a selection, and K = C W C with the weight W of a quadratic criterion, changed pose by pose ([`Change`]):
///
///   ln det M' = ln det M + ln det(I + G)
///   trace(W C') = trace(W C) - trace((I + G)^-1 H)
///
/// with G and H of [`Candidates`]: the gain of each candidate costs no more than its own readings' squares.
#[derive(Debug, Clone)]
pub(crate) struct State<'w> {
    pub(crate) rows: &'w Whitened,
    weight: Option<&'w DMatrix<f64>>,
    /// Information that is there without any pose: readings that are always there, and a ridge.
    base: DMatrix<f64>,
    pub(crate) chosen: Vec<bool>,
    covariance: DMatrix<f64>,
    /// K = C W C.
    weighted: DMatrix<f64>,
    pub(crate) log_det: f64,
    pub(crate) trace: f64,
    /// Readings of the chosen poses and those that are always there.
    pub(crate) readings: usize,
    /// As of the last [`State::catch_up`].
    pub(crate) candidates: Candidates<'w>,
}

impl<'w> State<'w> {
    /// The state of some chosen poses, with `ridge` times the unit information besides. None where they do not
    /// fix every parameter.
    pub(crate) fn new(
        rows: &'w Whitened,
        weight: Option<&'w DMatrix<f64>>,
        chosen: Vec<bool>,
        ridge: f64,
    ) -> Option<Self> {
        let count = rows.columns.len();
        let always = rows.rows.columns(0, rows.first[0]);
        let base = always * always.transpose() + DMatrix::identity(count, count) * ridge;
        let mut state = Self {
            rows,
            weight,
            base,
            chosen,
            covariance: DMatrix::zeros(count, count),
            weighted: DMatrix::zeros(count, count),
            log_det: 0.0,
            trace: 0.0,
            readings: 0,
            candidates: Candidates::new(rows, weight.is_some()),
        };
        state.refresh().then_some(state)
    }

    /// Works everything out anew from the chosen poses; false where they do not fix every parameter.
    pub(crate) fn refresh(&mut self) -> bool {
        let mut information = self.base.clone();
        self.readings = self.rows.first[0];
        for pose in 0..self.rows.poses() {
            if self.chosen[pose] {
                self.readings += self.rows.readings(pose);
                let of = self.rows.pose_rows(pose);
                for row in of.column_iter() {
                    information.ger(1.0, &row, &row, 1.0);
                }
            }
        }
        let Some(factor) = Cholesky::new(information) else {
            return false;
        };
        let lower = factor.l_dirty();
        let diagonal = || (0..lower.nrows()).map(|index| lower[(index, index)]);
        let (least, most) = diagonal().fold((f64::INFINITY, 0.0_f64), |(least, most), value| {
            (least.min(value), most.max(value))
        });
        // beyond this the square of the factor has no digit left
        if least.is_nan() || least <= 1e-7 * most {
            return false;
        }
        self.log_det = 2.0 * diagonal().map(f64::ln).sum::<f64>();
        self.covariance = factor.inverse();
        if let Some(weight) = self.weight {
            self.weighted = &self.covariance * weight * &self.covariance;
            self.trace = self.covariance.dot(weight);
        }
        self.candidates.forget();
        true
    }

    /// Number of free parameters.
    pub(crate) fn parameters(&self) -> usize {
        self.covariance.nrows()
    }

    /// Lets the candidates catch up with the selection.
    pub(crate) fn catch_up(&mut self) {
        self.candidates.catch_up(&self.covariance, &self.weighted);
    }

    /// What changes when a pose comes (1) or goes (-1); none where the others would not fix every parameter.
    pub(crate) fn change(&self, pose: usize, sign: f64) -> Option<Change> {
        let of = self.rows.pose_rows(pose);
        Change::new(of, &self.covariance, self.weight, sign)
    }

    /// Makes the change of a pose.
    pub(crate) fn make(&mut self, pose: usize, change: Change) {
        change.make(&mut self.covariance, &mut self.weighted);
        self.log_det += change.log_det;
        self.trace += change.trace;
        self.chosen[pose] = change.sign > 0.0;
        let count = self.rows.readings(pose);
        self.readings = match self.chosen[pose] {
            true => self.readings + count,
            false => self.readings - count,
        };
        self.candidates.note(change);
    }

    /// Takes a pose in.
    pub(crate) fn add(&mut self, pose: usize) -> bool {
        self.change(pose, 1.0)
            .map(|change| self.make(pose, change))
            .is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn remove(state: &mut State<'_>, pose: usize) -> bool {
        let change = state.change(pose, -1.0);
        change.map(|change| state.make(pose, change)).is_some()
    }

    /// Candidates of one to three readings of four parameters.
    fn candidates(numbers: &[f64]) -> Whitened {
        let mut first = vec![0];
        let rows = numbers.len() / 4;
        let mut end = 0;
        while end < rows {
            end = (end + 1 + first.len() % 3).min(rows);
            first.push(end);
        }
        Whitened::of_rows(
            DMatrix::from_column_slice(4, rows, &numbers[..4 * rows]),
            first,
        )
    }

    fn close(a: &[f64], b: &[f64]) -> bool {
        let size = b.iter().fold(1.0_f64, |size, value| size.max(value.abs()));
        a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-9 * size)
    }

    proptest! {
        #[test]
        fn updates_equal_recomputation(
            numbers in proptest::collection::vec(-1.0..1.0_f64, 120),
            task in proptest::collection::vec(-1.0..1.0_f64, 8),
            moves in proptest::collection::vec(0..15_usize, 1..25),
        ) {
            let rows = candidates(&numbers);
            let task = DMatrix::from_column_slice(4, 2, &task);
            let weight = &task * task.transpose();
            let chosen = vec![false; rows.poses()];
            let mut state = State::new(&rows, Some(&weight), chosen, 0.1).unwrap();
            for (number, pose) in moves.into_iter().enumerate() {
                let pose = pose % rows.poses();
                let (before, trace) = (state.log_det, state.trace);
                // candidates that are asked for seldom catch up with several changes at once
                let asked = (number % 3 == 0).then(|| {
                    state.catch_up();
                    let mut unchanged = state.candidates.changed(None);
                    let (det, fall) = state.candidates.gains(&mut unchanged, pose);
                    (det.ln(), fall)
                });
                if state.chosen[pose] {
                    prop_assert!(remove(&mut state, pose));
                } else {
                    prop_assert!(state.add(pose));
                    if let Some((gain, fall)) = asked {
                        prop_assert!((state.log_det - before - gain).abs() < 1e-9);
                        prop_assert!((trace - state.trace - fall).abs() < 1e-9 * (1.0 + trace));
                    }
                }
                let mut anew = state.clone();
                prop_assert!(anew.refresh());
                prop_assert!((anew.log_det - state.log_det).abs() < 1e-9);
                prop_assert!((anew.trace - state.trace).abs() < 1e-9 * (1.0 + anew.trace));
                prop_assert_eq!(anew.readings, state.readings);
                let mut late = state.clone();
                late.catch_up();
                anew.catch_up();
                let (late, wanted) = (late.candidates.numbers(), anew.candidates.numbers());
                prop_assert!(close(late.0, wanted.0));
                prop_assert!(close(late.1, wanted.1));
                let covariance = (state.covariance.as_slice(), anew.covariance.as_slice());
                prop_assert!(close(covariance.0, covariance.1));
            }
        }
    }

    proptest! {
        #[test]
        fn an_exchange_is_worth_what_it_is_worth_anew(
            numbers in proptest::collection::vec(-1.0..1.0_f64, 120),
            task in proptest::collection::vec(-1.0..1.0_f64, 8),
        ) {
            let rows = candidates(&numbers);
            let task = DMatrix::from_column_slice(4, 2, &task);
            let weight = &task * task.transpose();
            let chosen: Vec<bool> = (0..rows.poses()).map(|pose| pose % 2 == 0).collect();
            for weight in [None, Some(&weight)] {
                let mut state = State::new(&rows, weight, chosen.clone(), 0.1).unwrap();
                state.catch_up();
                for (out, into) in (0..rows.poses()).flat_map(|a| (0..rows.poses()).map(move |b| (a, b))) {
                    let Some(gone) = (state.chosen[out] && !state.chosen[into]).then(|| state.change(out, -1.0)) else {
                        continue;
                    };
                    let gone = gone.unwrap();
                    let mut changed = state.candidates.changed(Some(&gone));
                    let most = state.candidates.gains_at_most(&changed, into);
                    let (det, fall) = state.candidates.gains(&mut changed, into);
                    prop_assert!(most.0 >= det * (1.0 - 1e-12) && most.1 >= fall * (1.0 - 1e-12) - 1e-12);
                    let mut anew = state.clone();
                    prop_assert!(remove(&mut anew, out) && anew.add(into));
                    let change = anew.log_det - state.log_det;
                    prop_assert!((gone.log_det + det.ln() - change).abs() < 1e-9);
                    if weight.is_some() {
                        let change = anew.trace - state.trace;
                        prop_assert!((gone.trace - fall - change).abs() < 1e-9 * (1.0 + state.trace));
                    }
                }
            }
        }
    }

    #[test]
    fn the_only_pose_that_fixes_a_parameter_stays() {
        let rows = DMatrix::from_column_slice(2, 3, &[1.0, 0.0, 0.0, 1.0, 2.0, 0.0]);
        let rows = Whitened::of_rows(rows, vec![0, 1, 2, 3]);
        let mut state = State::new(&rows, None, vec![true; 3], 0.0).unwrap();
        assert!(!remove(&mut state, 1));
        assert!(state.chosen[1]);
        assert!(remove(&mut state, 2));
        // 1 and 1 are left of 5 and 1
        assert!(state.log_det.abs() < 1e-12);
        assert!(State::new(&rows, None, vec![true, false, true], 0.0).is_none());
    }
}
