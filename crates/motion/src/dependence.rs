//! What a torque's gap depends on: free functions of one quantity after the other, beside the base model.
//!
//! Chebyshev polynomials are a basis of smooth functions on an interval (Mason and Handscomb, *Chebyshev Polynomials*, 2003); the
//! share of a gap that such functions of a quantity take off says how far the gap follows it.

use std::rc::Rc;

use haptical_linalg::hat_functions;

use crate::fit::base::Base;
use crate::fit::column::Column;
use crate::fit::problem::Problem;
use crate::select::Fitted;
use crate::thresholds::examine::{CLEAR, FRICTION_KNOTS, PRODUCT_DEGREE, QUANTITY_DEGREE};

/// A quantity that a torque may follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Position of the joint.
    Position,
    /// Its speed, direction included.
    Velocity,
    /// Its acceleration.
    Acceleration,
    /// What its links ask of its drive.
    Load,
    /// Time.
    Time,
}

/// How much of a joint's gap free functions of a quantity explain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dependence {
    /// The quantity.
    pub quantity: Quantity,
    /// Share of the gap, 0 to 1.
    pub share: f64,
}

/// Quantities in the order in which equal shares are told.
const QUANTITIES: [Quantity; 5] = [
    Quantity::Position,
    Quantity::Velocity,
    Quantity::Load,
    Quantity::Acceleration,
    Quantity::Time,
];

/// What the rest of a fit depends on at a joint, most first.
pub(crate) fn dependences(
    problem: &Problem,
    base: &Base,
    fitted: &Fitted,
    joint: usize,
) -> Vec<Dependence> {
    let Some(excess) = excess(problem, fitted, joint) else {
        return Vec::new();
    };
    let mut found: Vec<Dependence> = (QUANTITIES.into_iter())
        .map(|quantity| {
            let signals = signals(problem, base, joint, quantity);
            Dependence {
                quantity,
                share: (explained(problem, fitted, joint, &signals) / excess).clamp(0.0, 1.0),
            }
        })
        .collect();
    found.sort_by(|a, b| b.share.total_cmp(&a.share));
    found
}

/// Share of the rest at a joint that functions of its position and of a neighbour's explain.
pub(crate) fn share_of_posture(problem: &Problem, fitted: &Fitted, joint: usize) -> f64 {
    let Some(excess) = excess(problem, fitted, joint) else {
        return 0.0;
    };
    let q = |joint: usize| chebyshev(&problem.states.link.q[joint], QUANTITY_DEGREE);
    let own = q(joint);
    let mut signals = own.clone();
    let neighbours = [joint.checked_sub(1), Some(joint + 1)];
    let joints = problem.arm.joints();
    for other in neighbours.into_iter().flatten().filter(|own| *own < joints) {
        let other = q(other);
        for a in &own[..PRODUCT_DEGREE] {
            signals.extend(other[..PRODUCT_DEGREE].iter().map(|b| product(a, b)));
        }
        signals.extend(other);
    }
    (explained(problem, fitted, joint, &signals) / excess).clamp(0.0, 1.0)
}

/// Share of the rest at a joint that friction by its position explains: another level wherever it is, against its motion.
pub(crate) fn share_of_friction(
    problem: &Problem,
    base: &Base,
    fitted: &Fitted,
    joint: usize,
) -> f64 {
    let Some(excess) = excess(problem, fitted, joint) else {
        return 0.0;
    };
    let sign = base.sign(problem, joint);
    let q = &problem.states.link.q[joint];
    let [low, high] = range(q);
    // a joint that rests is in one piece
    let hats = hat_functions(q, [low, high.max(low + 1e-9)], FRICTION_KNOTS);
    let signals: Vec<Vec<f64>> = hats.iter().map(|own| product(own, &sign)).collect();
    (explained(problem, fitted, joint, &signals) / excess).clamp(0.0, 1.0)
}

/// Energy beyond noise that a fit leaves of a joint \[nats\]; none where there is none.
fn excess(problem: &Problem, fitted: &Fitted, joint: usize) -> Option<f64> {
    let rows = problem.states.rows();
    let rest = &fitted.solved.rest[problem.channel_of(joint)? * rows..][..rows];
    let excess = 0.5 * (haptical_linalg::dot(rest, rest) - rows as f64);
    (excess > 0.0).then_some(excess)
}

/// What signals take off the rest of a joint beside all that is fitted, what they would of noise allowed for \[nats\].
fn explained(problem: &Problem, fitted: &Fitted, joint: usize, signals: &[Vec<f64>]) -> f64 {
    let columns = signals.iter().map(|own| problem.of_joint(joint, own));
    let columns: Vec<Rc<Column>> = columns.flatten().map(Rc::new).collect();
    let across = fitted.system.across(&columns);
    let gain = fitted.solved.gain_of_clear(&columns, &across, CLEAR);
    gain.nats - 0.5 * gain.rank as f64
}

fn signals(problem: &Problem, base: &Base, joint: usize, quantity: Quantity) -> Vec<Vec<f64>> {
    let states = &problem.states;
    let sign = || base.sign(problem, joint);
    // friction turns over with the direction
    let on_both_sides = |values: &[f64], degree: usize| {
        let mut all = chebyshev(values, degree);
        let sign = sign();
        let turned: Vec<Vec<f64>> = all.iter().map(|own| product(own, &sign)).collect();
        all.extend(turned);
        all
    };
    match quantity {
        Quantity::Position => chebyshev(&states.link.q[joint], QUANTITY_DEGREE),
        Quantity::Velocity => on_both_sides(&states.motor.dq[joint], QUANTITY_DEGREE),
        Quantity::Acceleration => chebyshev(&states.motor.ddq[joint], QUANTITY_DEGREE),
        Quantity::Load => on_both_sides(&problem.rigid[joint], QUANTITY_DEGREE / 2),
        Quantity::Time => on_both_sides(&states.time_s, QUANTITY_DEGREE),
    }
}

/// Least and most of values.
fn range(values: &[f64]) -> [f64; 2] {
    let low = values.iter().fold(f64::INFINITY, |low, own| low.min(*own));
    let high = (values.iter()).fold(f64::NEG_INFINITY, |high, own| high.max(*own));
    [low, high]
}

/// Chebyshev polynomials of the first kind from degree 1 on, of values put on -1 to 1.
fn chebyshev(values: &[f64], degree: usize) -> Vec<Vec<f64>> {
    let [low, high] = range(values);
    let half = (0.5 * (high - low)).max(1e-12);
    let x: Vec<f64> = values.iter().map(|own| (own - low) / half - 1.0).collect();
    let mut all = vec![x.clone()];
    let mut before = vec![1.0; x.len()];
    while all.len() < degree {
        let last = &all[all.len() - 1];
        let next = (0..x.len()).map(|k| 2.0 * x[k] * last[k] - before[k]);
        let next: Vec<f64> = next.collect();
        before = last.clone();
        all.push(next);
    }
    all
}

fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chebyshev_polynomials_are_cosines_of_multiples() {
        let angles: Vec<f64> = (0..50)
            .map(|k| f64::from(k) / 49.0 * std::f64::consts::PI)
            .collect();
        let values: Vec<f64> = angles.iter().map(|angle| 3.0 + 2.0 * angle.cos()).collect();
        for (index, own) in chebyshev(&values, 6).iter().enumerate() {
            for (found, angle) in own.iter().zip(&angles) {
                let wanted = ((index + 1) as f64 * angle).cos();
                assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
            }
        }
    }
}
