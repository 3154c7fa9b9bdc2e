//! Friction that builds up over a travel after each reversal.

use std::rc::Rc;

use crate::effect::{Candidate, Context, Effect, ends, first};
use crate::fit::base::beyond_sign;
use crate::thresholds::effect::{FRICTION_LAW_SD, PRESLIDING_S, SHORTEST_PRESLIDING_S};

pub(in crate::effect) const EFFECT: Effect = Effect::new("presliding", candidates).of_own_joint();

fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    context.at_joints(|joint| {
        let travels = PRESLIDING_S.map(|time_s| time_s * fastest(context, joint));
        travels
            .into_iter()
            .filter_map(|travel| at(context, joint, travel))
            .collect()
    })
}

fn fastest(context: Context<'_>, joint: usize) -> f64 {
    let [low, high] = ends(context.speed(joint));
    high.max(-low)
}

/// `z - s(dq)` with Dahl's `dz = (sign(dq) - z) |dq| / x dt` (Dahl 1968): beside the base model's Coulomb friction, whose size takes
/// it off again.
fn at(context: Context<'_>, joint: usize, travel: f64) -> Option<Candidate<'_>> {
    if travel < SHORTEST_PRESLIDING_S * fastest(context, joint) {
        return None;
    }
    let states = &context.problem.states;
    let signal = beyond_sign(states, &states.motor.q[joint], &context.sign(joint), travel);
    let found = context.of_signals(EFFECT.name, joint, &[signal], first("torque_nm"))?;
    let again = Rc::new(move |travel| at(context, joint, travel));
    Some(
        found
            .if_positive()
            .about_to(FRICTION_LAW_SD)
            .shape_about_to(FRICTION_LAW_SD)
            .shaped(("travel_rad", travel), 2.0, again),
    )
}
