//! Torques that are logged before the positions that belong to them, or after.

use super::{Candidate, Context, Effect, Found, first};
use crate::change::Change;
use crate::fit::base::slope;

/// Positions of all joints are late.
pub(crate) const ENCODER_LATENCY: Effect =
    Effect::new("encoder-latency", of_all).changing(of_all_torques);

/// Positions of one joint are late.
pub(super) const OF_ONE_ENCODER: Effect = Effect::new(ENCODER_LATENCY.name, of_one_encoder);

/// The torque of one joint is late.
pub(crate) const TORQUE_LATENCY: Effect = Effect::new("torque-latency", of_one)
    .of_own_joint()
    .changing(of_one_torque);

/// Late positions of all joints are early torques, which a device file can state. Of one joint they are late in the others' torques too.
fn of_all_torques(found: &Found<'_>) -> Option<Change> {
    let is_of_all = found.joint.is_none();
    let delay_s = found.number("delay_s").filter(|_| is_of_all)?;
    Some(Change::TorqueDelay {
        joint: None,
        more_s: -delay_s,
    })
}

fn of_one_torque(found: &Found<'_>) -> Option<Change> {
    Some(Change::TorqueDelay {
        joint: Some(found.joint?),
        more_s: found.number("delay_s")?,
    })
}

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
