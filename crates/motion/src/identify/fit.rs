//! Friction laws, delay and weights, by least squares that are repeated until they stand still.

use std::rc::Rc;

use haptical_linalg::dot;

use crate::MotionError;
use crate::fit::column::Column;
use crate::fit::problem::Problem;
use crate::fit::system::System;
use crate::identify::friction::{self, FrictionLaw};
use crate::identify::numbers::{Number, columns};
use crate::thresholds::identify::{
    DELAY_STEPS, FIT_ROUNDS, LEAST_FALL, LEAST_ROW_SD, LONGEST_DELAY_S, LONGEST_DELAY_STEPS,
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

/// Settles friction, delay and weights of a problem, whose weights are those that are found: until a further round changes no law of friction, and
/// lowers the cost by less than [`LEAST_FALL`].
///
/// # Errors
/// The rounds go on: such a fit is no measurement.
pub(crate) fn settle(problem: &mut Problem, numbers: &[Number]) -> Result<Settled, MotionError> {
    let mut friction = friction::first(problem);
    let mut early_s = 0.0;
    let noise = problem.row_sd.clone();
    let longest_s = (LONGEST_DELAY_STEPS * problem.samples.step_s).max(LONGEST_DELAY_S);
    // laws that were left, and the cost with them
    let mut before: Option<(Vec<FrictionLaw>, f64)> = None;
    let (mut cost, mut is_free) = (f64::INFINITY, true);
    for _ in 0..FIT_ROUNDS {
        let mut all = columns(problem, numbers, &friction, early_s);
        let target = problem.recorded(early_s);
        let chosen = is_free.then(|| friction::choose(problem, numbers, &all, &target));
        let mut is_still = chosen.as_ref().is_none_or(|own| *own == friction);
        if let Some(chosen) = chosen.filter(|_| !is_still) {
            before = Some((std::mem::replace(&mut friction, chosen), cost));
            all = columns(problem, numbers, &friction, early_s);
        }
        let delay = numbers.iter().position(|own| *own == Number::Delay);
        let mut rest = Vec::new();
        let mut fall = f64::INFINITY;
        let mut system = System::new(&all, &vec![None; all.len()]);
        for _ in 0..DELAY_STEPS {
            let solved = system.solve(&problem.recorded(early_s), &[]);
            rest.clone_from(&solved.rest);
            fall = 0.0;
            let Some(place) = delay else { break };
            let before_s = early_s;
            early_s = (early_s + solved.solution[place]).clamp(-longest_s, longest_s);
            let variance = solved.covariance(&[place])[(0, 0)];
            if early_s == before_s || variance <= 0.0 {
                break;
            }
            fall = (early_s - before_s).powi(2) / variance;
            if fall < LEAST_FALL {
                break;
            }
            let slope = crate::identify::numbers::delay(problem, early_s);
            system.replace(place, Rc::new(slope));
        }
        let rows = problem.states.rows();
        cost = -2.0 * friction::margin(problem, &friction);
        let sds = (noise.iter().enumerate()).map(|(channel, noise)| {
            let own = &rest[channel * rows..][..rows];
            let square = dot(own, own);
            let weighed = problem.weight(channel * rows).recip();
            let torque = problem
                .states
                .torque(&problem.samples, problem.channels[channel], 0.0);
            let size = (dot(&torque, &torque) / rows as f64).sqrt();
            let sd = (weighed * (square / rows as f64).sqrt())
                .max(*noise)
                .max(LEAST_ROW_SD * size);
            let ratio = weighed / sd;
            // twice the logarithm of the likelihood
            fall += square * (1.0 - ratio * ratio) + 2.0 * rows as f64 * ratio.ln();
            cost += square * ratio * ratio + 2.0 * rows as f64 * sd.ln();
            sd
        });
        let sds: Vec<f64> = sds.collect();
        problem.reweigh(&sds);
        // laws that take turns, as each is chosen beside the numbers of the other
        if let Some((laws, _)) = before.take_if(|own| cost > own.1 - LEAST_FALL) {
            (friction, is_free, is_still) = (laws, false, false);
        }
        if is_still && fall < LEAST_FALL {
            return Ok(Settled {
                friction,
                early_s,
                row_sd: problem.row_sd.clone(),
            });
        }
    }
    Err(MotionError::Fit(format!(
        "friction, delay and noise still change after {FIT_ROUNDS} rounds, so no number has an interval; record a longer or faster motion"
    )))
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
