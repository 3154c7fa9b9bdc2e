//! Friction that grows with the load of the joint.

use super::{Candidate, Candidates, Context, Effect, first, product};

pub(super) const EFFECT: Effect = Effect {
    name: "load-friction",
    candidates: Candidates::Given(candidates),
};

/// `s(dq) |tau|` by the nominal bodies' torque, which a gear or a bearing carries (Hamon, Gautier and Garrec 2010).
fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    context.at_joints(|joint| {
        let load = context.problem.rigid[joint].iter().map(|own| own.abs());
        let signal = product(&context.sign(joint), load);
        let found = context.of_signals(EFFECT.name, joint, &[signal], first("per_nm"));
        found.map(Candidate::if_positive).into_iter().collect()
    })
}
