//! A joint whose zero is not where the device file says.

use std::rc::Rc;

use haptical_dynamics::TorqueDerivatives;

use super::{Candidate, Context, Effect, Finer, Found, first};
use crate::change::Change;
use crate::thresholds::effect::MOST_OFFSET_RAD;
use crate::thresholds::plausible;

pub(super) const EFFECT: Effect = Effect::new("joint-offset", candidates)
    .exact()
    .changing(change);

/// The links stand an angle `o` beside where the encoder says: `tau(theta + o) - tau(theta)` in all torques, by the nominal bodies. The
/// derivative comes first, then the secant through the angle that is found.
/// Each joint's, by the slope of the torques.
pub(crate) fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    let problem = context.problem;
    let (states, joints) = (&problem.states, problem.arm.joints());
    let mut signals = vec![vec![vec![0.0; states.steps()]; joints]; joints];
    let mut work = problem.arm.work();
    let (mut by_q, mut by_dq) = (vec![0.0; joints * joints], vec![0.0; joints * joints]);
    let mut at = [vec![0.0; joints], vec![0.0; joints], vec![0.0; joints]];
    for step in 0..states.steps() {
        place(context, step, &mut at);
        let out = TorqueDerivatives {
            by_q: &mut by_q,
            by_dq: &mut by_dq,
        };
        let bodies = &problem.arm.bodies;
        let done = bodies.derivatives(&at[0], &at[1], &at[2], &mut work, out);
        if done.is_err() {
            return Vec::new();
        }
        for (from, signals) in signals.iter_mut().enumerate() {
            for (joint, signal) in signals.iter_mut().enumerate() {
                signal[step] = by_q[joint * joints + from];
            }
        }
    }
    let of_joint = |(joint, signals): (usize, &Vec<Vec<f64>>)| of(context, joint, signals, None);
    signals.iter().enumerate().map(of_joint).collect()
}

/// The secant through an angle: exact where the coefficient is that angle.
fn secant(context: Context<'_>, joint: usize, offset_rad: f64) -> Option<Candidate<'_>> {
    let problem = context.problem;
    let (states, joints) = (&problem.states, problem.arm.joints());
    let mut signals = vec![vec![0.0; states.steps()]; joints];
    let mut work = problem.arm.work();
    let mut at = [vec![0.0; joints], vec![0.0; joints], vec![0.0; joints]];
    let mut torques = [vec![0.0; joints], vec![0.0; joints]];
    for step in 0..states.steps() {
        let bodies = &problem.arm.bodies;
        for (torques, moved_rad) in torques.iter_mut().zip([0.0, offset_rad]) {
            place(context, step, &mut at);
            at[0][joint] += moved_rad;
            let done = bodies.torques(&at[0], &at[1], &at[2], &mut work, torques);
            done.ok()?;
        }
        let [here, there] = &torques;
        for (signal, (here, there)) in signals.iter_mut().zip(here.iter().zip(there)) {
            signal[step] = (there - here) / offset_rad;
        }
    }
    Some(of(context, joint, &signals, Some(offset_rad)))
}

/// Where the links are at a fine step, with their speeds and accelerations.
fn place(context: Context<'_>, step: usize, at: &mut [Vec<f64>; 3]) {
    let link = &context.problem.states.link;
    for joint in 0..at[0].len() {
        at[0][joint] = link.q[joint][step];
        at[1][joint] = link.dq[joint][step];
        at[2][joint] = link.ddq[joint][step];
    }
}

fn of<'c>(
    context: Context<'c>,
    joint: usize,
    signals: &[Vec<f64>],
    about_rad: Option<f64>,
) -> Candidate<'c> {
    let problem = context.problem;
    let name = match problem.arm.slides(joint) {
        true => "offset_m",
        false => "offset_rad",
    };
    let columns = vec![problem.of_joints(signals)];
    let entry = Candidate::new(EFFECT.name, Some(joint), columns, first(name));
    Candidate {
        within: [-MOST_OFFSET_RAD, MOST_OFFSET_RAD],
        about: about_rad.into_iter().collect(),
        finer: Finer::About(Rc::new(move |entry| {
            let offset_rad = entry.first().copied().filter(|entry| *entry != 0.0)?;
            secant(context, joint, offset_rad)
        })),
        ..entry
    }
}

/// Whether a zero that is off by so much may be that of a sound arm.
pub(crate) fn is_calibration(numbers: &[(&'static str, f64, f64)]) -> bool {
    numbers.iter().any(|(name, offset, _)| match *name {
        "offset_rad" => offset.abs() <= plausible::ZERO_RAD,
        "offset_m" => offset.abs() <= plausible::ZERO_M,
        _ => false,
    })
}

fn change(found: &Found<'_>) -> Option<Change> {
    let joint = found.joint?;
    let mut numbers = found.numbers.iter();
    let offset = numbers.find(|entry| entry.0 == "offset_rad" || entry.0 == "offset_m")?;
    Some(Change::Offset {
        joint,
        more: offset.1,
    })
}
