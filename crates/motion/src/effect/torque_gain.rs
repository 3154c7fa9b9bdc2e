//! A torque that is logged in another scale.

use std::rc::Rc;

use super::{Candidate, Context, Effect, Finer};
use crate::thresholds::effect::{BODIES_LAW_SD, MOST_GAIN};

pub(crate) const EFFECT: Effect = Effect::new("torque-gain", candidates)
    .exact()
    .of_own_joint();

/// One factor on all torques: another unit, a torque constant that all drives share.
pub(super) const OF_ALL: Effect = Effect::new(EFFECT.name, of_all).exact();

/// `e tau` of all joints: the logged torques are 1 + e times the true ones.
fn of_all(context: Context<'_>) -> Vec<Candidate<'_>> {
    let column = context.problem.of_joints(&context.problem.nominal_torque());
    let numbers = |own: &[f64]| vec![("factor", 1.0 + own[0])];
    let own = Candidate::new(EFFECT.name, None, vec![column], Rc::new(numbers));
    let read = move |own: &[f64]| all_by_reading(context, own[0] / (1.0 + own[0]));
    vec![Candidate {
        law_sd: BODIES_LAW_SD,
        is_sound: |own| own[0] > -MOST_GAIN,
        finer: Finer::Correction(Rc::new(read)),
        ..own
    }]
}

/// `g tau` of all joints by the logged torques, as for one joint.
fn all_by_reading(context: Context<'_>, gain: f64) -> Option<Candidate<'_>> {
    let problem = context.problem;
    let mut signals = vec![vec![0.0; problem.states.steps()]; problem.arm.joints()];
    for &joint in &problem.channels {
        signals[joint] = problem.recorded_torque(joint);
    }
    let numbers = |own: &[f64]| vec![("factor", 1.0 / (1.0 - own[0]))];
    let column = problem.of_joints(&signals);
    let own = Candidate::new(EFFECT.name, None, vec![column], Rc::new(numbers));
    Some(Candidate {
        of_noise: of_noise(problem.channel_rows(), gain),
        is_sound: |own| own[0] < MOST_GAIN,
        law_sd: BODIES_LAW_SD,
        about: vec![gain],
        finer: Finer::Correction(Rc::new(move |own| all_by_reading(context, own[0]))),
        ..own
    })
}

/// What a share of the reading explains of the noise in it \[nats\].
fn of_noise(rows: usize, gain: f64) -> f64 {
    rows as f64 * (gain * (1.0 - 0.5 * gain)).max(0.0)
}

/// `e tau` by the nominal bodies' torque: the logged torque is 1 + e times the true one, and its gain as a device file has it what of a
/// reading is too much, e / (1 + e). What bodies and friction are beside the nominal ones has the log's scale too: settled by the reading itself.
fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    let nominal = context.problem.nominal_torque();
    context.at_joints(|joint| {
        let signal = nominal[joint].clone();
        let numbers = |own: &[f64]| vec![("gain", own[0] / (1.0 + own[0]))];
        let found = context.of_signals(EFFECT.name, joint, &[signal], Rc::new(numbers));
        let settled = found.map(|own| Candidate {
            law_sd: BODIES_LAW_SD,
            is_sound: |own| own[0] > -MOST_GAIN,
            finer: Finer::Correction(Rc::new(move |own| {
                by_reading(context, joint, own[0] / (1.0 + own[0]))
            })),
            ..own
        });
        settled.into_iter().collect()
    })
}

/// `g tau` by the logged torque. The noise of that is in the rows too: a share g takes `(1 - (1 - g)^2) / 2` of a row's off.
fn by_reading(context: Context<'_>, joint: usize, gain: f64) -> Option<Candidate<'_>> {
    let signal = context.problem.recorded_torque(joint);
    let numbers = |own: &[f64]| vec![("gain", own[0])];
    let mut found = context.of_signals(EFFECT.name, joint, &[signal], Rc::new(numbers))?;
    found.of_noise = of_noise(context.problem.states.rows(), gain);
    found.is_sound = |own| own[0] < MOST_GAIN;
    found.law_sd = BODIES_LAW_SD;
    found.about = vec![gain];
    found.finer = Finer::Correction(Rc::new(move |own| by_reading(context, joint, own[0])));
    Some(found)
}
