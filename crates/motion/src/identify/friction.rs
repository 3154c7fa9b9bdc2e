//! Which way a joint's Coulomb friction turns over: with its speed, or with a travel that it remembers.

use std::rc::Rc;

use crate::fit::base::{beyond_sign, sign};
use crate::fit::column::Column;
use crate::fit::problem::Problem;
use crate::fit::system::System;
use crate::identify::numbers::Number;
use crate::thresholds::identify::{
    FARTHEST_LOG_SIZE, FRICTION_LOG_STEP, FRICTION_ROUNDS, FRICTION_SPEEDS, FRICTION_TRAVELS,
    MEMORY_NATS_PER_ROW,
};

/// What Coulomb friction is a multiple of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FrictionLaw {
    /// `tanh(omega / speed)` \[rad/s\], \[m/s\].
    Speed(f64),
    /// Dahl's state over a travel: `dz = (sign(omega) - z) |omega| / travel dt` (Dahl 1968) \[rad\], \[m\].
    Travel(f64),
}

impl FrictionLaw {
    /// The same law with another size, the logarithm of its share given.
    pub(crate) fn scaled(self, log: f64) -> Self {
        let factor = log.clamp(-FARTHEST_LOG_SIZE, FARTHEST_LOG_SIZE).exp();
        match self {
            Self::Speed(own) => Self::Speed(factor * own),
            Self::Travel(own) => Self::Travel(factor * own),
        }
    }

    /// How its side changes with the logarithm of its size.
    pub(crate) fn by_turnover(self, problem: &Problem, joint: usize) -> Vec<f64> {
        let [above, below] = [FRICTION_LOG_STEP, -FRICTION_LOG_STEP]
            .map(|log| self.scaled(log).side(problem, joint));
        let pairs = above.iter().zip(below);
        pairs
            .map(|(a, b)| (a - b) / (2.0 * FRICTION_LOG_STEP))
            .collect()
    }

    /// Side on which the friction is at the fine steps, -1 to 1.
    pub(crate) fn side(self, problem: &Problem, joint: usize) -> Vec<f64> {
        match self {
            Self::Speed(speed) => sign(&problem.states.sliding[joint], speed),
            Self::Travel(travel) => {
                let q = &problem.states.motor.q[joint];
                beyond_sign(&problem.states, q, &vec![0.0; q.len()], travel)
            }
        }
    }
}

/// Friction that is a share of what a joint carries, `s |tau|`, by its side (Hamon, Gautier and Garrec 2010).
pub(crate) fn by_load(problem: &Problem, joint: usize, side: &[f64]) -> Vec<f64> {
    let load = problem.carried(joint);
    side.iter()
        .zip(load)
        .map(|(side, load)| side * load.abs())
        .collect()
}

/// Laws that every joint starts with.
pub(crate) fn first(problem: &Problem) -> Vec<FrictionLaw> {
    vec![FrictionLaw::Speed(FRICTION_SPEEDS[FRICTION_SPEEDS.len() / 2]); problem.arm.joints()]
}

/// What laws are ahead of others with a memory \[nats\].
pub(crate) fn margin(problem: &Problem, laws: &[FrictionLaw]) -> f64 {
    let is_ahead = |joint: &&usize| matches!(laws[**joint], FrictionLaw::Speed(_));
    let ahead = problem.channels.iter().filter(is_ahead).count();
    ahead as f64 * MEMORY_NATS_PER_ROW * problem.states.rows() as f64
}

/// The law of each joint that explains most of a target beside all other numbers.
pub(crate) fn choose(
    problem: &Problem,
    numbers: &[Number],
    columns: &[Rc<Column>],
    target: &[f64],
) -> Vec<FrictionLaw> {
    let is_coulomb = |number: &Number| {
        let is_beside = number.is_beside() && *number != Number::Delay;
        is_beside || matches!(number, Number::Coulomb { .. } | Number::Load { .. })
    };
    let others: Vec<Rc<Column>> = (numbers.iter().zip(columns))
        .filter(|(number, _)| !is_coulomb(number))
        .map(|(_, column)| Rc::clone(column))
        .collect();
    let system = System::new(&others, &vec![None; others.len()]);
    let solved = system.solve(target, &[]);
    let laws: Vec<FrictionLaw> = (FRICTION_SPEEDS.map(FrictionLaw::Speed).into_iter())
        .chain(FRICTION_TRAVELS.map(FrictionLaw::Travel))
        .collect();
    let of_joint = |joint: usize| -> Vec<(Rc<Column>, Vec<f64>)> {
        let columns = laws.iter().filter_map(|law| {
            let own = Rc::new(problem.of_joint(joint, &law.side(problem, joint))?);
            let across = system.across(std::slice::from_ref(&own)).pop()?;
            Some((own, across))
        });
        columns.collect()
    };
    let tried: Vec<Vec<(Rc<Column>, Vec<f64>)>> = problem
        .channels
        .iter()
        .map(|joint| of_joint(*joint))
        .collect();
    let mut chosen = vec![FRICTION_SPEEDS.len() / 2; problem.channels.len()];
    let margin = MEMORY_NATS_PER_ROW * problem.states.rows() as f64;
    for round in 0..FRICTION_ROUNDS {
        let before = chosen.clone();
        for channel in 0..problem.channels.len() {
            let beside = (0..tried.len()).filter(|other| round > 0 && *other != channel);
            let beside: Vec<_> = beside.map(|other| &tried[other][chosen[other]]).collect();
            let gain = |law: usize| {
                let all = beside.iter().copied().chain([&tried[channel][law]]);
                let (columns, across): (Vec<_>, Vec<_>) = all.cloned().unzip();
                let bonus = if law < FRICTION_SPEEDS.len() {
                    margin
                } else {
                    0.0
                };
                solved.gain(&columns, &across).nats + bonus
            };
            let gains: Vec<f64> = (0..tried[channel].len()).map(gain).collect();
            let best = (0..gains.len()).max_by(|a, b| gains[*a].total_cmp(&gains[*b]));
            chosen[channel] = best.unwrap_or(chosen[channel]);
        }
        if round > 0 && chosen == before {
            break;
        }
    }
    let mut found = first(problem);
    for (joint, law) in problem.channels.iter().zip(chosen) {
        found[*joint] = laws[law];
    }
    found
}
