//! Numbers of an effect with their standard deviations.

use std::ops::Range;

use haptical_linalg::dot;

use super::Fitted;
use crate::effect::Candidate;

/// By the slopes of the numbers; `misfit` widens for what all effects leave. Numbers of a shape are as they were settled.
pub(super) fn numbers(
    fitted: &Fitted<'_>,
    columns: Range<usize>,
    candidate: &Candidate<'_>,
    misfit: f64,
) -> Vec<(&'static str, f64, f64)> {
    let at = fitted.effect_solution[columns.clone()].to_vec();
    let rows = fitted.span.inverse_rows(&fitted.effect_columns[columns]);
    let values = (candidate.numbers)(&at);
    let mut found: Vec<(&'static str, f64, f64)> = Vec::new();
    for (index, (name, value)) in values.iter().enumerate() {
        let mut along = vec![0.0; fitted.span.rank()];
        for (column, row) in rows.iter().enumerate() {
            let step = 1e-3 * dot(row, row).sqrt();
            if step == 0.0 {
                continue;
            }
            let moved = |by: f64| {
                let mut at = at.clone();
                at[column] += by;
                (candidate.numbers)(&at)[index].1
            };
            let slope = (moved(step) - moved(-step)) / (2.0 * step);
            (along.iter_mut().zip(row)).for_each(|(into, own)| *into += slope * own);
        }
        found.push((name, *value, (misfit * dot(&along, &along)).sqrt()));
    }
    found.extend(
        candidate
            .shape
            .iter()
            .map(|(name, value)| (*name, *value, 0.0)),
    );
    found
}
