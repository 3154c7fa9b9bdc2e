//! A spring or a counterweight between neighbouring links.

use std::rc::Rc;

use super::{Candidate, Context, Effect, ends};
use crate::thresholds::effect::LEAST_TRAVEL_RAD;

pub(crate) const EFFECT: Effect = Effect::new("gravity-spring", candidates)
    .exact()
    .of_own_joint();

/// A torque that depends on the joint's own angle alone: straight (a torsion spring) or a sine (a counterweight, a spring on a
/// crank).
fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    let states = &context.problem.states;
    context.at_joints(|joint| {
        let q = &states.motor.q[joint];
        let straight = q.clone();
        let ones = vec![1.0; q.len()];
        let spring = |own: &[f64]| vec![("stiffness_nm_per_rad", own[1])];
        let [low, high] = ends(q);
        let sines = [
            q.iter().map(|q| q.sin()).collect(),
            q.iter().map(|q| q.cos()).collect(),
        ];
        let crank = |own: &[f64]| vec![("moment_nm", own[0].hypot(own[1]))];
        let crank_seen = high - low > LEAST_TRAVEL_RAD;
        [
            context.of_signals(EFFECT.name, joint, &[ones, straight], Rc::new(spring)),
            context.of_signals(EFFECT.name, joint, &sines, Rc::new(crank)),
        ]
        .into_iter()
        .flatten()
        .enumerate()
        .map(|(kind, own)| Candidate {
            needs_last: true,
            // of less travel it is not told from a constant, though it may be predicted there
            // no spring has a stiffness below zero
            is_sound: match kind {
                0 => |own| own[1] >= 0.0,
                _ if crank_seen => |_| true,
                _ => |_| false,
            },
            ..own.of_kind(kind)
        })
        .collect()
    })
}
