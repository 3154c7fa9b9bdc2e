//! Friction that grows with the load of the joint.

use std::rc::Rc;

use crate::effect::{Candidate, Context, Effect, Finer, first, product};
use crate::thresholds::effect::{FRICTION_LAW_SD, MOST_OF_LOAD};

pub(in crate::effect) const EFFECT: Effect =
    Effect::new("load-friction", candidates).of_own_joint();

/// `s(dq) |tau|` by the torque of the nominal bodies, which a bearing carries, or of the whole drive, which a gear does (Hamon, Gautier and
/// Garrec 2010).
fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    context.at_joints(|joint| {
        let loads = [&context.problem.rigid[joint], &context.torque[joint]];
        let found = loads.into_iter().enumerate().filter_map(|(kind, load)| {
            let own = of(context, joint, &sizes(load))?;
            Some(Candidate {
                finer: Finer::Correction(Rc::new(move |own| by_recorded(context, joint, own[0]))),
                ..own.of_kind(kind)
            })
        });
        found.collect()
    })
}

fn sizes(torque: &[f64]) -> Vec<f64> {
    torque.iter().map(|own| own.abs()).collect()
}

fn of<'c>(context: Context<'c>, joint: usize, load: &[f64]) -> Option<Candidate<'c>> {
    let signal = product(&context.sign(joint), load.iter().copied());
    let found = context.of_signals(EFFECT.name, joint, &[signal], first("share"));
    found.map(|own| Candidate {
        within: [0.0, MOST_OF_LOAD],
        ..own.if_positive().about_to(FRICTION_LAW_SD)
    })
}

/// By the drive's torque as it was recorded, this friction included. The noise of that is in the rows too: a factor `c` takes
/// `(1 - (1 - c)^2) / 2` of a row's off.
fn by_recorded(context: Context<'_>, joint: usize, per_nm: f64) -> Option<Candidate<'_>> {
    if !(0.0..MOST_OF_LOAD).contains(&per_nm) {
        return None;
    }
    let load = sizes(&context.problem.recorded_torque(joint));
    let mut found = of(context, joint, &load)?.of_kind(1);
    let rows = context.problem.states.rows() as f64;
    found.of_noise = rows * per_nm * (1.0 - 0.5 * per_nm);
    found.about = vec![per_nm];
    found.finer = Finer::Correction(Rc::new(move |own| by_recorded(context, joint, own[0])));
    Some(found)
}
