//! The base model fitted to the times of a recording that agree with each other, and the times that do not.
//!
//! Least trimmed squares by concentration steps (Rousseeuw and Van Driessen 2006): what happens for a part of a recording alone
//! does not bend the fit of the rest.

use std::rc::Rc;

use haptical_linalg::dot;

use crate::fit::base::Base;
use crate::fit::column::Column;
use crate::fit::problem::Problem;
use crate::fit::system::System;
use crate::thresholds::fit::{AGREEING_SQUARE, CONCENTRATION_STEPS, LEAST_AGREEING, OUTSIDE_SDS};

/// Times that do not agree with the others.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Outside {
    /// Row by row of one joint.
    pub(crate) rows: Vec<bool>,
    /// Square of what the fit of the others leaves there, channel by channel.
    pub(crate) squares: Vec<f64>,
}

/// The times outside; none where the rest does not agree either, or nothing is outside.
pub(crate) fn outside(problem: &Problem, base: &Base) -> Option<Outside> {
    let rows = problem.states.rows();
    let channels = problem.channels.len();
    let recorded = problem.recorded(0.0);
    let columns: Vec<&Column> = base.columns.iter().map(|own| own.column.as_ref()).collect();
    let mut inside = vec![true; rows];
    let mut squares = vec![0.0; rows];
    let mut rest = Vec::new();
    let mut step = 0;
    while step <= CONCENTRATION_STEPS {
        rest = rest_of(problem, base, &columns, &recorded, &inside)?;
        for (row, square) in squares.iter_mut().enumerate() {
            *square = (0..channels)
                .map(|own| rest[own * rows + row].powi(2))
                .sum::<f64>()
                / channels as f64;
        }
        let mut order = squares.clone();
        let kept = ((LEAST_AGREEING * rows as f64) as usize).min(rows - 1);
        let (_, most, _) = order.select_nth_unstable_by(kept, f64::total_cmp);
        let most = match step < CONCENTRATION_STEPS {
            true => *most,
            false => 1.0 + OUTSIDE_SDS * (2.0 / channels as f64).sqrt(),
        };
        let now: Vec<bool> = squares.iter().map(|square| *square <= most).collect();
        // what has settled is ready for the last step
        step = match step + 1 < CONCENTRATION_STEPS && now == inside {
            true => CONCENTRATION_STEPS,
            false => step + 1,
        };
        inside = now;
    }
    let agreeing: Vec<f64> = (squares.iter().zip(&inside))
        .filter(|(_, inside)| **inside)
        .map(|own| *own.0)
        .collect();
    let mean = agreeing.iter().sum::<f64>() / agreeing.len().max(1) as f64;
    let is_found = agreeing.len() < rows
        && agreeing.len() as f64 > 0.5 * rows as f64
        && mean < AGREEING_SQUARE;
    let of_channel = |channel: usize| {
        let own = rest[channel * rows..][..rows].iter().zip(&inside);
        own.filter(|(_, inside)| !**inside)
            .map(|(rest, _)| rest * rest)
            .sum()
    };
    is_found.then(|| Outside {
        squares: (0..channels).map(of_channel).collect(),
        rows: inside.iter().map(|own| !own).collect(),
    })
}

/// What a fit to the times inside leaves of all.
fn rest_of(
    problem: &Problem,
    base: &Base,
    columns: &[&Column],
    recorded: &[f64],
    inside: &[bool],
) -> Option<Vec<f64>> {
    let rows = problem.states.rows();
    let masked = columns
        .iter()
        .map(|column| Rc::new(column.masked(|k| inside[k % rows])));
    let known: Vec<Option<f64>> = base.columns.iter().map(|own| own.known_sd).collect();
    let solved = System::new(&masked.collect::<Vec<_>>(), &known).solve(recorded, &[]);
    let mut rest = recorded.to_vec();
    for (column, value) in columns.iter().zip(&solved.solution) {
        column.add_to(&mut rest, -value);
    }
    dot(&rest, &rest).is_finite().then_some(rest)
}
