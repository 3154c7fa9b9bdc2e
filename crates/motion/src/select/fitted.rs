//! The base model and effects that were taken, fitted together, with plausible limits kept.

use haptical_linalg::dot;

use crate::base::{Base, Term};
use crate::plausible;
use crate::problem::Problem;
use crate::span::{Column, Span};

/// Times that numbers beyond their limits are put at them.
const ROUNDS: usize = 4;

/// A fit.
pub(crate) struct Fitted<'c> {
    pub(crate) problem: &'c Problem,
    pub(crate) base: &'c Base,
    /// Directions of what is free, and of the effects behind it.
    pub(crate) span: Span,
    /// Coefficients of the base model's columns, those at their limits included.
    pub(crate) base_solution: Vec<f64>,
    /// Coefficients of the effects' columns.
    pub(crate) effect_solution: Vec<f64>,
    /// Columns of the span that the effects' are.
    pub(crate) effect_columns: Vec<usize>,
    /// What is left, row by row, known numbers last.
    pub(crate) rest: Vec<f64>,
    /// Rows that a rest may have of noise.
    pub(crate) freedom: f64,
}

impl<'c> Fitted<'c> {
    /// The fit with some effects; `early_s`: how long the torques are before the positions, which is an effect then.
    pub(crate) fn new(
        problem: &'c Problem,
        base: &'c Base,
        effects: &[Column],
        early_s: Option<f64>,
    ) -> Self {
        let recorded = problem.recorded(early_s.unwrap_or(0.0));
        let is_asked =
            |index: usize| early_s.is_none() || !matches!(base.columns[index].term, Term::Delay);
        let mut at_limit: Vec<Option<f64>> = vec![None; base.columns.len()];
        let mut round = 0;
        loop {
            let free: Vec<usize> = (0..base.columns.len())
                .filter(|&index| at_limit[index].is_none() && is_asked(index))
                .collect();
            let mut span = base.span(problem, &free);
            effects.iter().for_each(|column| {
                span.add(column, problem.length());
            });
            let mut target = recorded.clone();
            for (index, value) in at_limit.iter().enumerate() {
                if let Some(value) = value {
                    base.columns[index].column.add_to(&mut target, -value);
                }
            }
            let solution = span.solve(&target);
            let mut base_solution: Vec<f64> =
                at_limit.iter().map(|own| own.unwrap_or(0.0)).collect();
            (free.iter().zip(&solution)).for_each(|(index, value)| base_solution[*index] = *value);
            let mut is_settled = true;
            for &index in &free {
                let own = &base.columns[index];
                let Some(limit) = own.known_sd.map(|sd| plausible::LIMIT_SDS * sd) else {
                    continue;
                };
                if base_solution[index].abs() > limit {
                    at_limit[index] = Some(base_solution[index].clamp(-limit, limit));
                    is_settled = false;
                }
            }
            round += 1;
            if !is_settled && round < ROUNDS {
                continue;
            }
            return Self {
                problem,
                base,
                effect_solution: solution[free.len()..].to_vec(),
                effect_columns: (free.len()..free.len() + effects.len()).collect(),
                rest: span.rest_of(target),
                freedom: problem.channel_rows() as f64 - base.free() as f64,
                span,
                base_solution,
            };
        }
    }

    /// Energy beyond noise of what is left.
    pub(crate) fn excess(&self) -> f64 {
        0.5 * (dot(&self.rest, &self.rest) - self.freedom)
    }
}
