//! Friction that is higher near rest.

use std::rc::Rc;

use crate::effect::{Candidate, Context, Effect, ends, first, product};
use crate::thresholds::effect::{FRICTION_LAW_SD, STRIBECK_SPEEDS, STRIBECK_TURNOVERS};

pub(in crate::effect) const EFFECT: Effect =
    Effect::new("stribeck-friction", candidates).of_own_joint();

fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    context.at_joints(|joint| {
        let [low, high] = ends(context.speed(joint));
        let speeds = STRIBECK_SPEEDS.map(|share| share * high.max(-low));
        let slowest = STRIBECK_TURNOVERS * context.base.reversals[joint].turnover;
        let slow = speeds.into_iter().filter(|speed| *speed >= slowest);
        slow.filter_map(|speed| at(context, joint, speed)).collect()
    })
}

/// `s(dq) exp(-(dq / v)^2)` (Armstrong-Helouvry, Dupont and Canudas de Wit 1994, eq. 4).
fn at(context: Context<'_>, joint: usize, speed: f64) -> Option<Candidate<'_>> {
    if speed < STRIBECK_TURNOVERS * context.base.reversals[joint].turnover {
        return None;
    }
    let dq = context.speed(joint);
    let signal = product(
        &context.sign(joint),
        dq.iter().map(|dq| (-(dq / speed).powi(2)).exp()),
    );
    let mut found = context.of_signals(EFFECT.name, joint, &[signal], first("torque_nm"))?;
    // a drag that grows with the square of the speed bends friction as well
    let drag: Vec<f64> = dq.iter().map(|dq| dq * dq.abs()).collect();
    found.plain = context.problem.of_joint(joint, &drag).map(Rc::new);
    let again = Rc::new(move |speed| at(context, joint, speed));
    Some(
        found
            .if_positive()
            .about_to(FRICTION_LAW_SD)
            .shape_about_to(FRICTION_LAW_SD)
            .shaped(("speed_rad_per_s", speed), 2.0, again),
    )
}
