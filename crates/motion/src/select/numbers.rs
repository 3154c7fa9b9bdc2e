//! Numbers of an effect with their standard deviations.

use std::ops::Range;

use super::Fitted;
use crate::effect::Candidate;

/// By the slopes of the numbers; `misfit` widens for what all effects leave, `times` is how often what is known was counted, `shape_sd`
/// is of the logarithm of the shape's number.
pub(crate) fn numbers(
    fitted: &Fitted,
    columns: Range<usize>,
    candidate: &Candidate<'_>,
    ((misfit, times), shape_sd): ((f64, f64), f64),
) -> Vec<(&'static str, f64, f64)> {
    let at = fitted.effects()[columns.clone()].to_vec();
    let indices: Vec<usize> = columns.map(|column| fitted.base_columns + column).collect();
    let covariance = (fitted.system).scatter(&fitted.solved, &indices, (misfit, times));
    let values = (candidate.numbers)(&at);
    let mut found: Vec<(&'static str, f64, f64)> = Vec::new();
    for (index, (name, value)) in values.iter().enumerate() {
        let slope = |column: usize| {
            let step = 1e-3 * covariance[(column, column)].sqrt();
            if step == 0.0 {
                return 0.0;
            }
            let moved = |by: f64| {
                let mut at = at.clone();
                at[column] += by;
                (candidate.numbers)(&at)[index].1
            };
            (moved(step) - moved(-step)) / (2.0 * step)
        };
        let slopes = nalgebra::DVector::from_fn(at.len(), |column, _| slope(column));
        let variance = (slopes.transpose() * &covariance * &slopes)[(0, 0)];
        // a number of columns that no torque feels is not known
        let is_unfelt = || {
            (0..at.len()).any(|column| {
                let mut other = at.clone();
                other[column] += 1.0;
                covariance[(column, column)] == 0.0
                    && (candidate.numbers)(&other)[index].1 != *value
            })
        };
        if variance == 0.0 && is_unfelt() {
            continue;
        }
        let sd = variance.max(0.0).sqrt();
        let size = if *name == "phase_rad" { 1.0 } else { *value };
        found.push((name, *value, sd.hypot(candidate.law_sd * size)));
    }
    let shape_sd = shape_sd.hypot(candidate.shape_law_sd);
    found.extend(
        candidate
            .shape
            .iter()
            .map(|(name, value)| (*name, *value, (shape_sd * value).abs())),
    );
    found
}
