//! Torques that are logged before the positions that belong to them, or after.

use super::{Candidate, Context, Effect, first};
use crate::fit::base::slope;

/// Positions of all joints are late.
pub(crate) const ENCODER_LATENCY: Effect = Effect::new("encoder-latency", of_all);

/// Positions of one joint are late.
pub(super) const OF_ONE_ENCODER: Effect = Effect::new(ENCODER_LATENCY.name, of_one_encoder);

/// The torque of one joint is late.
pub(crate) const TORQUE_LATENCY: Effect = Effect::new("torque-latency", of_one).of_own_joint();

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
    one(context, TORQUE_LATENCY.name, -1.0)
}

/// Late positions of one joint are an early torque of it, but for what they do to the others.
fn of_one_encoder(context: Context<'_>) -> Vec<Candidate<'_>> {
    one(context, OF_ONE_ENCODER.name, 1.0)
}

fn one<'c>(context: Context<'c>, name: &'static str, sense: f64) -> Vec<Candidate<'c>> {
    context.at_joints(|joint| {
        let slope = slope(&context.torque[joint], context.problem);
        let signal: Vec<f64> = slope.iter().map(|own| sense * own).collect();
        let found = context.of_signals(name, joint, &[signal], first("delay_s"));
        found.map(Candidate::if_positive).into_iter().collect()
    })
}
