//! A constant that is added to a torque.

use super::{Candidate, Context, Effect, first};

pub(super) const EFFECT: Effect = Effect::new("torque-offset", candidates)
    .exact()
    .of_own_joint();

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
