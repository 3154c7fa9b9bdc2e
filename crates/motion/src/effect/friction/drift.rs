//! Friction that changes while the log runs.

use std::rc::Rc;

use crate::effect::{Candidate, Context, Effect, product};
use crate::thresholds::effect::FRICTION_LAW_SD;

pub(in crate::effect) const EFFECT: Effect =
    Effect::new("friction-drift", candidates).of_own_joint();

/// `s(dq) f(t)` and `dq f(t)`, with f straight or settling within a third of the log.
fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    let times = &context.problem.states.time_s;
    let (start, end) = (times.iter()).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), t| {
        (low.min(*t), high.max(*t))
    });
    let span_s = (end - start).max(1e-9);
    let straight: Vec<f64> = times.iter().map(|t| (t - start) / span_s - 0.5).collect();
    let settling: Vec<f64> = (times.iter())
        .map(|t| (-3.0 * (t - start) / span_s).exp() - 0.3)
        .collect();
    context.at_joints(|joint| {
        let sign = context.sign(joint);
        let of = |(course, sense): (&Vec<f64>, f64)| {
            let coulomb = product(&sign, course.iter().copied());
            let viscous = product(context.speed(joint), course.iter().copied());
            let numbers = move |own: &[f64]| {
                vec![
                    ("coulomb_nm", sense * own[0]),
                    ("viscous_nm_s_per_rad", sense * own[1]),
                ]
            };
            context.of_signals(EFFECT.name, joint, &[coulomb, viscous], Rc::new(numbers))
        };
        let courses = [(&straight, 1.0), (&settling, -1.0)]
            .into_iter()
            .filter_map(of);
        courses
            .enumerate()
            .map(|(kind, own)| own.of_kind(kind).about_to(FRICTION_LAW_SD))
            .collect()
    })
}
