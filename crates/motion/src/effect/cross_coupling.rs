//! A drive whose cable or shaft passes another joint and loads it.

use super::{Candidate, Context, Effect};
use std::rc::Rc;

use crate::thresholds::effect::MOST_COUPLING;

pub(super) const EFFECT: Effect = Effect::new("cross-coupling", candidates).exact();

/// A share of one drive's torque on another joint: an entry beside the diagonal of the transmission's matrix, which joint torques are the
/// transpose of times motor torques (Tsai, Robot Analysis, 1999). A drive passes the joints between its motor and its own, so that it loads
/// those before it, or a neighbour by a differential. The torque is the recorded one: it has all that the drive really does.
fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    let problem = context.problem;
    let torques: Vec<(usize, Vec<f64>)> = (problem.channels.iter())
        .map(|&joint| (joint, problem.recorded_torque(joint)))
        .collect();
    context.at_joints(|joint| {
        let passes = |from: usize| from > joint || from + 1 == joint;
        (torques.iter())
            .filter(|(from, _)| passes(*from))
            .filter_map(|(from, torque)| {
                let number = (*from + 1) as f64;
                let numbers = move |own: &[f64]| vec![("gain", own[0])];
                let own = context.of_signals(
                    EFFECT.name,
                    joint,
                    std::slice::from_ref(torque),
                    Rc::new(numbers),
                )?;
                let shape = vec![("from_joint", number)];
                Some(Candidate {
                    shape,
                    within: [-MOST_COUPLING, MOST_COUPLING],
                    ..own.of_kind(*from)
                })
            })
            .collect()
    })
}
