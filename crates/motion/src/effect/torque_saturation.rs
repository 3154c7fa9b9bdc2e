//! A drive that gives less than the torque that is logged.

use std::rc::Rc;

use super::{Candidate, Candidates, Context, Effect, ends};

pub(super) const EFFECT: Effect = Effect {
    name: "torque-saturation",
    candidates: Candidates::Given(candidates),
};

/// Shares of the largest torque at which it may set in.
const LIMITS: [f64; 8] = [0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.87, 0.93];
/// How far the share of the excess that is lost may be from all of it.
const NEAR_ALL: f64 = 0.15;

fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    context.at_joints(|joint| {
        let [low, high] = ends(&context.problem.recorded_torque(joint));
        let limits = LIMITS.map(|share| share * high.max(-low));
        limits
            .into_iter()
            .filter_map(|limit| at(context, joint, limit))
            .collect()
    })
}

/// What the logged torque is beyond a limit on each side, the noise of its readings smoothed; all of it is lost, so its coefficients
/// are 1.
fn at(context: Context<'_>, joint: usize, limit: f64) -> Option<Candidate<'_>> {
    let logged = context.problem.recorded_torque(joint);
    let sides = [
        logged
            .iter()
            .map(|own| (own - limit).max(0.0))
            .collect::<Vec<f64>>(),
        logged.iter().map(|own| (own + limit).min(0.0)).collect(),
    ];
    let sides: Vec<Vec<f64>> = sides
        .into_iter()
        .filter(|side| side.iter().any(|own| *own != 0.0))
        .collect();
    let mut found = context.of_signals(EFFECT.name, joint, &sides, Rc::new(|_| Vec::new()))?;
    found.is_sound = |own| {
        own.iter()
            .all(|own| *own == 0.0 || (own - 1.0).abs() < NEAR_ALL)
    };
    let again = Rc::new(move |limit| at(context, joint, limit));
    (!sides.is_empty()).then(|| found.shaped(("limit_nm", limit), 1.15, again))
}
