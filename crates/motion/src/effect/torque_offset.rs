//! A constant that is added to a torque.

use super::{Candidate, Context, Effect, Found, first};
use crate::change::Change;

pub(super) const EFFECT: Effect = Effect::new("torque-offset", candidates)
    .exact()
    .of_own_joint()
    .changing(change);

fn change(found: &Found<'_>) -> Option<Change> {
    Some(Change::TorqueOffset {
        joint: found.joint?,
        more_nm: found.number("torque_nm")?,
    })
}

fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    let ones = vec![1.0; context.problem.states.steps()];
    context.at_joints(|joint| {
        let found = context.of_signals(
            EFFECT.name,
            joint,
            std::slice::from_ref(&ones),
            first("torque_nm"),
        );
        found.into_iter().collect()
    })
}
