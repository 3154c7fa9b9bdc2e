//! An inertia of the motor's side that is another than the stated one.

use super::{Candidate, Context, Effect, Found, first};
use crate::change::Change;

pub(crate) const EFFECT: Effect = Effect::new("armature", candidates)
    .exact()
    .of_own_joint()
    .changing(change);

fn change(found: &Found<'_>) -> Option<Change> {
    Some(Change::Armature {
        joint: found.joint?,
        more_kgm2: found.number("inertia_kgm2")?,
    })
}

/// `I ddq` of a joint whose armature is stated; one that is not is part of the base model.
fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    context.at_joints(|joint| {
        if context.problem.arm.armature[joint].is_none() {
            return Vec::new();
        }
        let signal = context.problem.states.motor.ddq[joint].clone();
        let found = context.of_signals(EFFECT.name, joint, &[signal], first("inertia_kgm2"));
        found.into_iter().collect()
    })
}
