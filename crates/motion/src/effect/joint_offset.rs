//! A joint whose zero is not where the device file says.

use std::rc::Rc;

use super::{Candidate, Context, Effect, Finer, Found, first};
use crate::change::Change;
use crate::thresholds::effect::{MOST_OFFSET_RAD, SMALL_OFFSET_RAD};

pub(super) const EFFECT: Effect = Effect::new("joint-offset", candidates)
    .exact()
    .changing(change);

/// The links stand an angle `o` beside where the encoder says: `tau(theta + o) - tau(theta)` in all torques, by the nominal bodies. It is
/// linear about a small angle first, and about the one that is found then.
fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    let joints = 0..context.problem.arm.joints();
    joints
        .filter_map(|joint| about(context, joint, SMALL_OFFSET_RAD))
        .collect()
}

/// The secant through an angle: exact where the coefficient is that angle.
fn about(context: Context<'_>, joint: usize, offset_rad: f64) -> Option<Candidate<'_>> {
    let problem = context.problem;
    let (states, joints) = (&problem.states, problem.arm.joints());
    let mut signals = vec![vec![0.0; states.steps()]; joints];
    let mut work = problem.arm.work();
    let mut at = [vec![0.0; joints], vec![0.0; joints], vec![0.0; joints]];
    let mut torques = vec![0.0; joints];
    for step in 0..states.steps() {
        for own in 0..joints {
            at[0][own] = states.link.q[own][step];
            at[1][own] = states.link.dq[own][step];
            at[2][own] = states.link.ddq[own][step];
        }
        let bodies = &problem.arm.bodies;
        for (sign, moved_rad) in [(1.0, offset_rad), (-1.0, 0.0)] {
            at[0][joint] = states.link.q[joint][step] + moved_rad;
            bodies
                .torques(&at[0], &at[1], &at[2], &mut work, &mut torques)
                .ok()?;
            for (signal, torque) in signals.iter_mut().zip(&torques) {
                signal[step] += sign * torque / offset_rad;
            }
        }
    }
    let name = match problem.arm.slides(joint) {
        true => "offset_m",
        false => "offset_rad",
    };
    let columns = vec![problem.of_joints(&signals)];
    let own = Candidate::new(EFFECT.name, Some(joint), columns, first(name));
    Some(Candidate {
        within: [-MOST_OFFSET_RAD, MOST_OFFSET_RAD],
        about: vec![offset_rad],
        finer: Finer::About(Rc::new(move |own| about(context, joint, own[0]))),
        ..own
    })
}

fn change(found: &Found<'_>) -> Option<Change> {
    let joint = found.joint?;
    let mut offset = found.numbers.iter();
    let offset = offset.find(|own| own.0 == "offset_rad" || own.0 == "offset_m")?;
    Some(Change::Offset {
        joint,
        more: offset.1,
    })
}
