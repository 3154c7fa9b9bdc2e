//! Friction laws, delay and weights, by least squares that are repeated until they stand still.

use std::rc::Rc;

use haptical_linalg::dot;

use crate::fit::column::Column;
use crate::fit::problem::Problem;
use crate::fit::system::System;
use crate::identify::friction::{self, FrictionLaw};
use crate::identify::numbers::{Number, columns};
use crate::thresholds::identify::{
    DELAY_STEPS, DELAY_TOLERANCE, FIT_ROUNDS, LEAST_ROW_SD, LONGEST_DELAY_S, LONGEST_DELAY_STEPS,
};

/// What is settled before numbers are told apart.
#[derive(Debug, Clone)]
pub(crate) struct Settled {
    pub(crate) friction: Vec<FrictionLaw>,
    /// How long torques are logged before their positions \[s\].
    pub(crate) early_s: f64,
    /// Standard deviation of a row of each channel: what is left, and no less than the noise.
    pub(crate) row_sd: Vec<f64>,
}

/// Settles friction, delay and weights of a problem, whose weights are those that are found.
pub(crate) fn settle(problem: &mut Problem, numbers: &[Number]) -> Settled {
    let mut friction = friction::first(problem);
    let mut early_s = 0.0;
    let noise = problem.row_sd.clone();
    let longest_s = (LONGEST_DELAY_STEPS * problem.samples.step_s).max(LONGEST_DELAY_S);
    for _ in 0..FIT_ROUNDS {
        let all = columns(problem, numbers, &friction, early_s);
        friction = friction::choose(problem, numbers, &all, &problem.recorded(early_s));
        let mut all = columns(problem, numbers, &friction, early_s);
        let delay = numbers.iter().position(|own| *own == Number::Delay);
        let mut rest = Vec::new();
        for _ in 0..DELAY_STEPS {
            let system = System::new(&all, &vec![None; all.len()]);
            let solved = system.solve(&problem.recorded(early_s), &[]);
            rest = solved.rest;
            let Some(place) = delay else { break };
            let before_s = early_s;
            early_s = (early_s + solved.solution[place]).clamp(-longest_s, longest_s);
            if (early_s - before_s).abs() < DELAY_TOLERANCE * problem.samples.step_s {
                break;
            }
            all[place] = Rc::new(crate::identify::numbers::delay(problem, early_s));
        }
        let rows = problem.states.rows();
        let sds = (noise.iter().enumerate()).map(|(channel, noise)| {
            let own = &rest[channel * rows..][..rows];
            let left = (dot(own, own) / rows as f64).sqrt() / problem.weight(channel * rows);
            let torque = problem
                .states
                .torque(&problem.samples, problem.channels[channel], 0.0);
            let size = (dot(&torque, &torque) / rows as f64).sqrt();
            left.max(*noise).max(LEAST_ROW_SD * size)
        });
        let sds: Vec<f64> = sds.collect();
        problem.reweigh(&sds);
    }
    Settled {
        friction,
        early_s,
        row_sd: problem.row_sd.clone(),
    }
}

/// What numbers leave of the recorded torques.
pub(crate) fn rest(target: &[f64], columns: &[Rc<Column>], values: &[f64]) -> Vec<f64> {
    let mut rest = target.to_vec();
    for (column, value) in columns.iter().zip(values) {
        if *value != 0.0 {
            column.add_to(&mut rest, -value);
        }
    }
    rest
}
