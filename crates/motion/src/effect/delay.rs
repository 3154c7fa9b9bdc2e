//! Torques that are logged before the positions that belong to them, or after.

use super::{Candidate, Candidates, Context, Effect, first};
use crate::base::slope;

/// Positions of all joints are late.
pub(super) const ENCODER_LATENCY: Effect = Effect {
    name: "encoder-latency",
    candidates: Candidates::Given(of_all),
};

/// The torque of one joint is late.
pub(super) const TORQUE_LATENCY: Effect = Effect {
    name: "torque-latency",
    candidates: Candidates::Given(of_one),
};

/// By the first order of the delay; the fit goes on from there ([`crate::select`]).
fn of_all(context: Context<'_>) -> Vec<Candidate<'_>> {
    let slopes = context.torque.iter().map(|own| slope(own, context.problem));
    let column = context.problem.of_joints(&slopes.collect::<Vec<_>>());
    vec![Candidate::new(
        ENCODER_LATENCY.name,
        None,
        vec![column],
        first("delay_s"),
    )]
}

fn of_one(context: Context<'_>) -> Vec<Candidate<'_>> {
    context.at_joints(|joint| {
        let late: Vec<f64> = (slope(&context.torque[joint], context.problem).iter())
            .map(|own| -own)
            .collect();
        let found = context.of_signals(TORQUE_LATENCY.name, joint, &[late], first("delay_s"));
        found.into_iter().collect()
    })
}
