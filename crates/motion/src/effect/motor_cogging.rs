//! A torque that repeats with the motor's angle.

use std::rc::Rc;

use haptical_linalg::dot;

use super::{Candidate, Candidates, Context, Effect, ends};
use crate::fit::problem::Problem;
use crate::thresholds::effect::{
    COGGING_KEPT, COGGING_LAW_SD, HIGHEST_OF_SLIDE, HIGHEST_ORDER, LEAST_PERIODS, MOST_ORDERS,
};

pub(super) const EFFECT: Effect = Effect {
    candidates: Candidates::ByRest(candidates),
    ..Effect::new("motor-cogging", |_| Vec::new()).of_own_joint()
};

/// The orders of which a periodogram of the rest over the joint's angle shows most.
fn candidates<'c>(context: Context<'c>, rest: &[f64]) -> Vec<Candidate<'c>> {
    let problem = context.problem;
    context.at_joints(|joint| {
        let Some(channel) = problem.channel_of(joint) else {
            return Vec::new();
        };
        let q = &problem.states.motor.q[joint];
        let [low, high] = ends(q);
        let travel = (high - low).max(1e-6);
        let rows = problem.states.rows();
        let rest = &rest[channel * rows..][..rows];
        let step = 0.5 * std::f64::consts::PI / travel;
        let lowest = LEAST_PERIODS * std::f64::consts::TAU / travel;
        let highest = match problem.arm.slides(joint) {
            true => HIGHEST_OF_SLIDE,
            false => HIGHEST_ORDER,
        };
        let count = (((highest - lowest) / step).max(0.0) as usize).min(MOST_ORDERS);
        let mut scan = scan(problem, (channel, q), rest, (lowest, step, count));
        scan.sort_by(|a, b| b.0.total_cmp(&a.0));
        scan.truncate(COGGING_KEPT);
        scan.iter()
            .filter_map(|(_, order)| at(context, joint, *order, step))
            .collect()
    })
}

/// Sine and cosine of an order times an angle; an effect has its second harmonic too, since poles and slots are no sines.
fn sines(q: &[f64], order: f64) -> [Vec<f64>; 2] {
    let [mut sine, mut cosine] = [Vec::with_capacity(q.len()), Vec::with_capacity(q.len())];
    for q in q {
        let (s, c) = (order * q).sin_cos();
        sine.push(s);
        cosine.push(c);
    }
    [sine, cosine]
}

/// Sines and cosines of evenly spaced orders, one after the other; they are turned on from one order to the next.
fn each_wave(
    q: &[f64],
    (lowest, step, count): (f64, f64, usize),
    mut visit: impl FnMut(f64, &[Vec<f64>; 2]),
) {
    let mut signals = sines(q, lowest);
    let [sine_of_step, cosine_of_step] = sines(q, step);
    for k in 0..=count {
        visit(lowest + k as f64 * step, &signals);
        let [sines, cosines] = &mut signals;
        let turns = sine_of_step.iter().zip(&cosine_of_step);
        for ((sine, cosine), (s, c)) in sines.iter_mut().zip(cosines).zip(turns) {
            (*sine, *cosine) = (*sine * c + *cosine * s, *cosine * c - *sine * s);
        }
    }
}

/// What evenly spaced orders take off the rest, the base model left out of it, each with its order.
fn scan(
    problem: &Problem,
    (channel, q): (usize, &[f64]),
    rest: &[f64],
    orders: (f64, f64, usize),
) -> Vec<(f64, f64)> {
    let states = &problem.states;
    let squares = problem.wave_squares[channel].get_or_init(|| {
        let mut all = Vec::with_capacity(orders.2 + 1);
        let square = |signal: &Vec<f64>| {
            let row = states.filtered(signal);
            dot(&row, &row)
        };
        each_wave(q, orders, |_, signals| {
            all.push([square(&signals[0]), square(&signals[1])]);
        });
        all
    });
    let spread = states.spread(rest);
    let mut found = Vec::with_capacity(orders.2 + 1);
    each_wave(q, orders, |order, signals| {
        let part = |of: usize| {
            let square = squares[found.len()][of].max(0.02 * rest.len() as f64);
            dot(&signals[of], &spread).powi(2) / square
        };
        found.push((part(0) + part(1), order));
    });
    found
}

fn at(context: Context<'_>, joint: usize, order: f64, step: f64) -> Option<Candidate<'_>> {
    let q = &context.problem.states.motor.q[joint];
    let numbers = |own: &[f64]| {
        vec![
            ("amplitude_nm", own[0].hypot(own[1])),
            ("phase_rad", own[0].atan2(own[1])),
        ]
    };
    let mut signals = sines(q, order).to_vec();
    signals.extend(sines(q, 2.0 * order));
    let found = context.of_signals(EFFECT.name, joint, &signals, Rc::new(numbers))?;
    // a phase that is off by the law's share at every angle by itself has a slope of its own: sqrt(12) over the travel of even angles
    let [low, high] = ends(q);
    let slope = COGGING_LAW_SD * 12_f64.sqrt() / (high - low).max(1e-6);
    let found = found.about_to(COGGING_LAW_SD).shape_about_to(slope / order);
    let again = Rc::new(move |order| at(context, joint, order, step));
    Some(found.shaped(("order", order), 1.0 + 0.7 * step / order, again))
}
