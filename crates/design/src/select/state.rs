//! The information of a selection of poses, kept up to date while poses come and go.

use nalgebra::{Cholesky, DMatrix};

use crate::select::gains::{dot, gains};
use crate::select::whitened::Whitened;

/// Covariance of a selection and what each candidate would change, updated pose by pose.
///
/// With C the covariance, X_j the rows of candidate j, W the weight of a quadratic criterion and K = C W C it
/// keeps G_j = X_j C X_j^T and H_j = X_j K X_j^T for every j. A pose with one reading is a rank-one update
/// (Sherman & Morrison 1950), one with q readings a rank-q update (Woodbury 1950):
///
///   C' = C - U U^T,  U = C X^T L^-T,  L L^T = I + G      (removed: C + U U^T, L L^T = I - G)
///   ln det M' = ln det M + ln det(I + G)
///   trace(W C') = trace(W C) - trace((I + G)^-1 H)
///
/// so that the gain of each candidate costs no more than its own readings' squares.
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
    /// G_j, q x q each, one after the other.
    spread: Vec<f64>,
    /// H_j.
    gained: Vec<f64>,
    /// First entry of each in both.
    place: Vec<usize>,
}

/// Least eigenvalue of I - G with which a pose may be taken out: without it the others must fix every
/// parameter.
const LEAST_LEFT: f64 = 1e-9;

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
        let mut place = vec![0];
        for pose in 0..rows.poses() {
            place.push(place[pose] + rows.readings(pose).pow(2));
        }
        let entries = place.last().copied().unwrap_or(0);
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
            spread: vec![0.0; entries],
            gained: vec![0.0; if weight.is_some() { entries } else { 0 }],
            place,
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
            self.trace = dot(self.covariance.as_slice(), weight.as_slice());
        }
        for pose in 0..self.rows.poses() {
            let of = self.rows.pose_rows(pose);
            let entries = self.place[pose]..self.place[pose + 1];
            let spread = of.tr_mul(&(&self.covariance * of));
            self.spread[entries.clone()].copy_from_slice(spread.as_slice());
            if self.weight.is_some() {
                let gained = of.tr_mul(&(&self.weighted * of));
                self.gained[entries].copy_from_slice(gained.as_slice());
            }
        }
        true
    }

    /// Number of free parameters.
    pub(crate) fn parameters(&self) -> usize {
        self.covariance.nrows()
    }

    /// By how much ln det M grows with a pose.
    pub(crate) fn log_det_gain(&self, pose: usize) -> f64 {
        match &self.spread[self.place[pose]..self.place[pose + 1]] {
            [one] => one.ln_1p(),
            spread => gains(self.rows.readings(pose), spread, None).0,
        }
    }

    /// By how much trace(W C) falls with a pose.
    pub(crate) fn trace_gain(&self, pose: usize) -> f64 {
        let entries = self.place[pose]..self.place[pose + 1];
        match (&self.spread[entries.clone()], &self.gained[entries]) {
            ([one], [gained]) => gained / (1.0 + one),
            (spread, gained) => gains(self.rows.readings(pose), spread, Some(gained)).1,
        }
    }

    /// Takes the place of another state of the same candidates, without allocation.
    pub(crate) fn take_from(&mut self, other: &Self) {
        self.chosen.clone_from(&other.chosen);
        self.covariance.copy_from(&other.covariance);
        self.weighted.copy_from(&other.weighted);
        self.log_det = other.log_det;
        self.trace = other.trace;
        self.readings = other.readings;
        self.spread.clone_from(&other.spread);
        self.gained.clone_from(&other.gained);
    }

    /// Takes a pose in.
    pub(crate) fn add(&mut self, pose: usize) -> bool {
        self.update(pose, true)
    }

    /// Takes a pose out; false, and nothing changed, where the others would not fix every parameter.
    pub(crate) fn remove(&mut self, pose: usize) -> bool {
        self.update(pose, false)
    }

    fn update(&mut self, pose: usize, is_in: bool) -> bool {
        let (count, sign) = (self.rows.readings(pose), if is_in { 1.0 } else { -1.0 });
        let spread = &self.spread[self.place[pose]..self.place[pose + 1]];
        let mut matrix = DMatrix::from_column_slice(count, count, spread) * sign;
        for index in 0..count {
            matrix[(index, index)] += 1.0;
        }
        let Some(factor) = Cholesky::new(matrix) else {
            return false;
        };
        let lower = factor.l();
        let diagonal: Vec<f64> = lower.diagonal().iter().copied().collect();
        if diagonal
            .iter()
            .any(|value| value.is_nan() || value * value < LEAST_LEFT)
        {
            return false;
        }
        self.log_det += 2.0 * diagonal.iter().map(|value| value.ln()).sum::<f64>();
        // U^T = L^-1 X C
        let mut turned = self.rows.pose_rows(pose).tr_mul(&self.covariance);
        lower.solve_lower_triangular_mut(&mut turned);
        let update = turned.transpose();
        let weighting = self.weight.map(|weight| {
            // K' = K - sign (U Z^T + Z U^T) + U B U^T with Z = C W U, B = U^T W U
            let pulled = weight * &update;
            (&self.covariance * &pulled, update.tr_mul(&pulled))
        });
        for row in update.column_iter() {
            self.covariance.ger(-sign, &row, &row, 1.0);
        }
        if let Some((along, inner)) = &weighting {
            self.trace -= sign * inner.trace();
            for (row, along) in update.column_iter().zip(along.column_iter()) {
                self.weighted.ger(-sign, &row, &along, 1.0);
                self.weighted.ger(-sign, &along, &row, 1.0);
            }
            self.weighted += &update * inner * update.transpose();
        }
        self.update_candidates(&update, weighting.as_ref(), sign);
        self.chosen[pose] = is_in;
        self.readings = match is_in {
            true => self.readings + count,
            false => self.readings - count,
        };
        true
    }

    /// G_j' = G_j - sign S S^T with S = X_j U, and H_j in the same way as K.
    fn update_candidates(
        &mut self,
        update: &DMatrix<f64>,
        weighting: Option<&(DMatrix<f64>, DMatrix<f64>)>,
        sign: f64,
    ) {
        let (height, rank) = update.shape();
        let column = |matrix: &DMatrix<f64>, index: usize| -> Vec<f64> {
            matrix.column(index).iter().copied().collect()
        };
        let moves: Vec<Vec<f64>> = (0..rank).map(|index| column(update, index)).collect();
        let alongs: Vec<Vec<f64>> = weighting.map_or_else(Vec::new, |(along, _)| {
            (0..rank).map(|index| column(along, index)).collect()
        });
        let design = self.rows.rows.as_slice();
        let (mut seen, mut pulled) = (Vec::new(), Vec::new());
        for pose in 0..self.rows.poses() {
            let count = self.rows.readings(pose);
            let start = self.rows.first[pose] * height;
            let own = &design[start..start + count * height];
            seen.clear();
            pulled.clear();
            for row in own.chunks_exact(height) {
                seen.extend(moves.iter().map(|other| dot(row, other)));
                pulled.extend(alongs.iter().map(|other| dot(row, other)));
            }
            let place = self.place[pose];
            for a in 0..count {
                for b in 0..count {
                    let (left, right) = (&seen[a * rank..][..rank], &seen[b * rank..][..rank]);
                    self.spread[place + a + b * count] -= sign * dot(left, right);
                    if let Some((_, inner)) = weighting {
                        let (pull_a, pull_b) =
                            (&pulled[a * rank..][..rank], &pulled[b * rank..][..rank]);
                        let mut change = -sign * (dot(left, pull_b) + dot(pull_a, right));
                        for (i, left) in left.iter().enumerate() {
                            for (j, right) in right.iter().enumerate() {
                                change += left * inner[(i, j)] * right;
                            }
                        }
                        self.gained[place + a + b * count] += change;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

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
            for pose in moves {
                let pose = pose % rows.poses();
                let (gain, fall) = (state.log_det_gain(pose), state.trace_gain(pose));
                let (before, trace) = (state.log_det, state.trace);
                if state.chosen[pose] {
                    prop_assert!(state.remove(pose));
                } else {
                    prop_assert!(state.add(pose));
                    prop_assert!((state.log_det - before - gain).abs() < 1e-9);
                    prop_assert!((trace - state.trace - fall).abs() < 1e-9 * (1.0 + trace));
                }
                let mut anew = state.clone();
                prop_assert!(anew.refresh());
                prop_assert!((anew.log_det - state.log_det).abs() < 1e-9);
                prop_assert!((anew.trace - state.trace).abs() < 1e-9 * (1.0 + anew.trace));
                prop_assert_eq!(anew.readings, state.readings);
                prop_assert!(close(&state.spread, &anew.spread));
                prop_assert!(close(&state.gained, &anew.gained));
                let covariance = (state.covariance.as_slice(), anew.covariance.as_slice());
                prop_assert!(close(covariance.0, covariance.1));
            }
        }
    }

    #[test]
    fn the_only_pose_that_fixes_a_parameter_stays() {
        let rows = DMatrix::from_column_slice(2, 3, &[1.0, 0.0, 0.0, 1.0, 2.0, 0.0]);
        let rows = Whitened::of_rows(rows, vec![0, 1, 2, 3]);
        let mut state = State::new(&rows, None, vec![true; 3], 0.0).unwrap();
        assert!(!state.remove(1));
        assert!(state.chosen[1]);
        assert!(state.remove(2));
        // 1 and 1 are left of 5 and 1
        assert!(state.log_det.abs() < 1e-12);
        assert!(State::new(&rows, None, vec![true, false, true], 0.0).is_none());
    }
}
