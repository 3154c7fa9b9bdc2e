//! Gains of a law, and how late it hears its command, by least squares.

use super::law::{Equations, Law, Signals};
use super::rows::Rows;
use crate::examined::is_beyond_noise;
use crate::fit::system::System;
use crate::thresholds::tracking::{DELAYS_S, PARABOLAS_S, SHARPNESS_S};

/// A joint's gains under a law and a delay.
#[derive(Debug, Clone)]
pub(super) struct JointFit {
    pub(super) solution: Vec<f64>,
    /// What is left of each row, in standard deviations of its noise.
    pub(super) rest: Vec<f64>,
    pub(super) square: f64,
}

/// A law with the delay that leaves least.
#[derive(Debug, Clone)]
pub(super) struct Found {
    pub(super) law: Law,
    pub(super) delay_s: f64,
    pub(super) sd_s: f64,
    /// Joint by joint.
    pub(super) fits: Vec<JointFit>,
    /// Twice the negative logarithm of the likelihood, the noise of each joint being what is left of it.
    pub(super) objective: f64,
}

impl JointFit {
    pub(super) fn is_noise(&self) -> bool {
        let rows = self.rest.len();
        !is_beyond_noise((self.square / rows as f64).sqrt(), rows)
    }
}

/// What is left of rows under gains.
pub(super) fn rest_of(equations: &Equations, solution: &[f64]) -> Vec<f64> {
    let mut rest = equations.target.clone();
    for (column, value) in equations.columns.iter().zip(solution) {
        column.add_to(&mut rest, -value);
    }
    rest
}

/// Fits a joint's gains; those that cannot be negative are zero where they would be.
pub(super) fn fit(equations: &Equations) -> JointFit {
    let system = System::new(&equations.columns, &vec![None; equations.columns.len()]);
    let mut fixed = vec![None; equations.columns.len()];
    loop {
        let solved = system.solve(&equations.target, &fixed);
        let negative = |own: &usize| equations.positive[*own] && solved.solution[*own] < 0.0;
        let wrong: Vec<usize> = (0..fixed.len()).filter(negative).collect();
        if wrong.is_empty() {
            return JointFit {
                square: haptical_linalg::dot(&solved.rest, &solved.rest),
                solution: solved.solution,
                rest: solved.rest,
            };
        }
        wrong.into_iter().for_each(|own| fixed[own] = Some(0.0));
    }
}

/// All joints under a law and a delay.
pub(super) fn fits(
    rows: &Rows,
    signals: &Signals,
    of: (Law, f64),
    joints: &[usize],
) -> Vec<JointFit> {
    let own = joints.iter();
    own.map(|index| fit(&signals.equations(rows, *index, of)))
        .collect()
}

/// The delay that leaves least of some joints' torques under a law.
pub(super) fn search(rows: &Rows, signals: &Signals, law: Law, joints: &[usize]) -> Found {
    let count = rows.count() as f64;
    let at = |delay_s: f64| {
        let fits = fits(rows, signals, (law, delay_s), joints);
        let objective: f64 = (fits.iter())
            .map(|own| count * (own.square / count).max(1e-12).ln())
            .sum();
        (delay_s, objective, fits)
    };
    let mut tried: Vec<_> = DELAYS_S.into_iter().map(at).collect();
    let best_of = |tried: &[(f64, f64, Vec<JointFit>)]| {
        let all = 0..tried.len();
        all.min_by(|a, b| tried[*a].1.total_cmp(&tried[*b].1))
            .unwrap_or(0)
    };
    // with the noise of each joint as the best one has it, squares are parabolas
    let of_best = |fits: &[JointFit], best: &[JointFit]| -> f64 {
        let both = fits.iter().zip(best);
        both.map(|(own, best)| own.square / best.square.max(1e-12))
            .sum()
    };
    // squares are no parabolas from one delay of the grid to the next: nearer and nearer ones
    for near_s in PARABOLAS_S {
        let middle_s = tried[best_of(&tried)].0;
        for next in [middle_s - near_s, middle_s + near_s] {
            let place = tried.partition_point(|own| own.0 < next);
            tried.insert(place, at(next));
        }
        let best = best_of(&tried);
        if best == 0 || best + 1 == tried.len() {
            break;
        }
        let [a, b, c] = [best - 1, best, best + 1].map(|k| {
            let own = of_best(&tried[k].2, &tried[best].2);
            (tried[k].0, own)
        });
        if let Some(next) = vertex(a, b, c) {
            let place = tried.partition_point(|own| own.0 < next);
            tried.insert(place, at(next));
        }
    }
    let (delay_s, objective, fits) = tried.swap_remove(best_of(&tried));
    let beside = [-SHARPNESS_S, SHARPNESS_S].map(|own| of_best(&at(delay_s + own).2, &fits));
    let sharp = count * (beside[0] + beside[1] - 2.0 * joints.len() as f64) / SHARPNESS_S.powi(2);
    Found {
        law,
        delay_s,
        sd_s: (2.0 / sharp.max(1e-12)).sqrt(),
        fits,
        objective,
    }
}

/// Lowest point of the parabola through three points, if it has one between the outer ones.
fn vertex(a: (f64, f64), b: (f64, f64), c: (f64, f64)) -> Option<f64> {
    let (left, right) = (b.0 - a.0, b.0 - c.0);
    let (down, up) = (b.1 - a.1, b.1 - c.1);
    let below = left * up - right * down;
    let next = b.0 - 0.5 * (left * left * up - right * right * down) / below;
    (next.is_finite() && next > a.0 && next < c.0).then_some(next)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_has_its_lowest_point_where_it_has() {
        let at = |x: f64| (x, 3.0 * (x - 0.013) * (x - 0.013) + 2.0);
        let found = vertex(at(0.0), at(0.01), at(0.04)).unwrap();
        assert!((found - 0.013).abs() < 1e-12, "{found}");
        assert_eq!(vertex(at(0.02), at(0.03), at(0.04)), None);
    }
}
