//! Friction that grows with the load of the joint.

use super::{Candidate, Candidates, Context, Effect, first, product};

pub(super) const EFFECT: Effect = Effect {
    name: "load-friction",
    candidates: Candidates::Given(candidates),
};

/// `s(dq) |tau|` by the torque of the nominal bodies, which a bearing carries, or of the whole drive, which a gear does (Hamon, Gautier and Garrec 2010).
fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    context.at_joints(|joint| {
        let of = |load: &[f64]| {
            let signal = product(&context.sign(joint), load.iter().map(|own| own.abs()));
            let found = context.of_signals(EFFECT.name, joint, &[signal], first("per_nm"));
            found.map(Candidate::if_positive)
        };
        let loads = [&context.problem.rigid[joint], &context.torque[joint]];
        let found = loads.into_iter().filter_map(|load| of(load)).enumerate();
        found.map(|(kind, own)| own.of_kind(kind)).collect()
    })
}
