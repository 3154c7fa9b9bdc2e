//! A torque that is logged in another scale.

use std::rc::Rc;

use super::{Candidate, Candidates, Context, Effect};

pub(super) const EFFECT: Effect = Effect {
    name: "torque-gain",
    candidates: Candidates::Given(candidates),
};

/// `e tau`: the logged torque is 1 + e times the true one; the gain of a device file is what of a reading is too much, e / (1 + e). By the nominal bodies' torque: the recorded one has noise, whose
/// square is no gain, and the friction is in the log's scale already.
fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    let nominal = context.problem.nominal_torque();
    context.at_joints(|joint| {
        let signal = nominal[joint].clone();
        let found = context.of_signals(
            EFFECT.name,
            joint,
            &[signal],
            Rc::new(|own: &[f64]| vec![("gain", own[0] / (1.0 + own[0]))]),
        );
        let mut found: Vec<_> = found.into_iter().collect();
        // a torque that is not there at all is no scale of it, nor is one of the wrong sign
        found
            .iter_mut()
            .for_each(|own| own.is_sound = |own| own[0] > -0.95);
        found
    })
}
