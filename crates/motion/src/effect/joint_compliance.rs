//! A spring between motor and link, seen from the motor's side alone.

use std::rc::Rc;

use haptical_dynamics::TorqueDerivatives;

use super::{Candidate, Context, Effect};
use crate::fit::base::slope;

pub(crate) const EFFECT: Effect = Effect::new("joint-compliance", candidates);

/// The link stands `tau / k` beside the motor: the torques change by their derivatives with that angle, its speed and its
/// acceleration. First order in 1/k (Spong 1987).
fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    let problem = context.problem;
    let (states, joints) = (&problem.states, problem.arm.joints());
    let steps = states.steps();
    let wind: Vec<[Vec<f64>; 3]> = (0..joints)
        .map(|joint| {
            let angle: Vec<f64> = problem.rigid[joint].iter().map(|own| -own).collect();
            let speed = slope(&angle, problem);
            let acceleration = slope(&speed, problem);
            [angle, speed, acceleration]
        })
        .collect();
    let mut signals = vec![vec![vec![0.0; steps]; joints]; joints];
    let mut work = problem.arm.work();
    let square = || vec![0.0; joints * joints];
    let (mut by_q, mut by_dq, mut mass) = (square(), square(), square());
    let mut at = [vec![0.0; joints], vec![0.0; joints], vec![0.0; joints]];
    for step in 0..steps {
        for joint in 0..joints {
            at[0][joint] = states.link.q[joint][step];
            at[1][joint] = states.link.dq[joint][step];
            at[2][joint] = states.link.ddq[joint][step];
        }
        let out = TorqueDerivatives {
            by_q: &mut by_q,
            by_dq: &mut by_dq,
        };
        let bodies = &problem.arm.bodies;
        let done = bodies
            .derivatives(&at[0], &at[1], &at[2], &mut work, out)
            .and_then(|()| bodies.mass_matrix(&at[0], &mut work, &mut mass));
        if done.is_err() {
            return Vec::new();
        }
        for (from, signals) in signals.iter_mut().enumerate() {
            let [angle, speed, acceleration] = &wind[from];
            for (joint, signal) in signals.iter_mut().enumerate() {
                let entry = joint * joints + from;
                let own = if joint == from {
                    problem.arm.armature[joint].unwrap_or(0.0)
                } else {
                    0.0
                };
                signal[step] = by_q[entry] * angle[step]
                    + by_dq[entry] * speed[step]
                    + (mass[entry] - own) * acceleration[step];
            }
        }
    }
    let mut pieces = problem.samples.pieces.iter();
    let has_encoder = pieces
        .next()
        .map(|own| own.link.iter().map(Option::is_some).collect::<Vec<_>>());
    context.at_joints(|joint| {
        // the link's own encoder is in the equations: a spring before it is no part of them
        if has_encoder.as_ref().is_some_and(|own| own[joint]) {
            return Vec::new();
        }
        let columns = vec![problem.of_joints(&signals[joint])];
        let numbers = |own: &[f64]| vec![("stiffness_nm_per_rad", 1.0 / own[0])];
        vec![Candidate::new(EFFECT.name, Some(joint), columns, Rc::new(numbers)).if_positive()]
    })
}
