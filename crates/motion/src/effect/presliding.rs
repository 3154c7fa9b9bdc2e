//! Friction that builds up over a travel after each reversal.

use std::rc::Rc;

use super::{Candidate, Candidates, Context, Effect, ends, first};

pub(super) const EFFECT: Effect = Effect {
    name: "presliding",
    candidates: Candidates::Given(candidates),
};

/// Travels that are tried, as shares of the joint's.
const TRAVELS: [f64; 5] = [0.0005, 0.002, 0.006, 0.02, 0.05];

fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    context.at_joints(|joint| {
        let [low, high] = ends(&context.problem.states.motor.q[joint]);
        let travels = TRAVELS.map(|share| share * (high - low));
        travels
            .into_iter()
            .filter_map(|travel| at(context, joint, travel))
            .collect()
    })
}

/// `z - s(dq)` with Dahl's `dz = (sign(dq) - z) |dq| / x dt` (Dahl 1968): beside the base model's Coulomb friction, whose size takes
/// it off again.
fn at(context: Context<'_>, joint: usize, travel: f64) -> Option<Candidate<'_>> {
    let q = &context.problem.states.motor.q[joint];
    let sign = context.sign(joint);
    let mut z = 0.0;
    let signal = (0..q.len())
        .map(|k| {
            let step = if k > 0 { q[k] - q[k - 1] } else { 0.0 };
            // exact over a step in one direction
            let towards = step.signum();
            z = towards + (z - towards) * (-step.abs() / travel.max(1e-12)).exp();
            z - sign[k]
        })
        .collect();
    let found = context.of_signals(EFFECT.name, joint, &[signal], first("torque_nm"))?;
    let again = Rc::new(move |travel| at(context, joint, travel));
    Some(
        found
            .if_positive()
            .shaped(("travel_rad", travel), 2.0, again),
    )
}
