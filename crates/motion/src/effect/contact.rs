//! A force on the flange for a part of the log.

use std::rc::Rc;

use nalgebra::Vector3;

use super::{Candidate, Candidates, Context, Effect};
use crate::fit::trimmed::{Outside, outside};

pub(super) const EFFECT: Effect = Effect {
    name: "contact",
    candidates: Candidates::Given(|context| candidate(context).into_iter().collect()),
};

/// Rows between the nodes of the force's course.
const NODES: f64 = 2.0;
/// Most nodes: a longer contact has them further apart.
const MOST_NODES: usize = 60;
/// A force at the flange is felt by several joints: the second most has this share of the squares of the most, at least.
const FELT_BY_TWO: f64 = 0.03;
/// A surface pushes in one direction: the mean force over the mean of its size, at least.
const ONE_WAY: f64 = 0.5;

/// Three components of a force at the flange, straight between nodes, at the times that do not agree with the others.
fn candidate(context: Context<'_>) -> Option<Candidate<'_>> {
    let problem = context.problem;
    let states = &problem.states;
    let Outside {
        rows: outside,
        squares,
    } = outside(problem, context.base)?;
    let mut sizes = squares;
    sizes.sort_by(|a, b| b.total_cmp(a));
    if sizes
        .get(1)
        .is_none_or(|second| *second < FELT_BY_TWO * sizes[0])
    {
        return None;
    }
    let share = outside.iter().filter(|own| **own).count() as f64 / outside.len() as f64;
    let times: Vec<f64> = states
        .centre
        .iter()
        .map(|step| states.time_s[*step])
        .collect();
    let row_s = states.pass.row_s();
    let total_s = share * outside.len() as f64 * row_s;
    let apart_s = (NODES * row_s).max(total_s / MOST_NODES as f64);
    let mut nodes: Vec<f64> = Vec::new();
    for (row, _) in outside.iter().enumerate().filter(|(_, own)| **own) {
        for time in [
            times[row] - 2.0 * row_s,
            times[row],
            times[row] + 2.0 * row_s,
        ] {
            // on one grid for the whole log
            let node = (time / apart_s).round() * apart_s;
            if nodes.last().is_none_or(|last| node > last + 0.5 * apart_s) {
                nodes.push(node);
            }
        }
    }
    let jacobian = jacobian(context)?;
    let mut columns = Vec::new();
    for node in nodes {
        for axis in 0..3 {
            let hat = |time: f64| (1.0 - ((time - node) / apart_s).abs()).max(0.0);
            let signals: Vec<Vec<f64>> = (jacobian.iter())
                .map(|own| {
                    (own[axis].iter().zip(&states.time_s))
                        .map(|(own, time)| -own * hat(*time))
                        .collect()
                })
                .collect();
            columns.push(problem.of_joints(&signals));
        }
    }
    let numbers = move |own: &[f64]| {
        let force = own
            .chunks(3)
            .map(|own| Vector3::from_column_slice(own).norm());
        vec![("share", share), ("force_n", force.fold(0.0, f64::max))]
    };
    let mut found = Candidate::new(EFFECT.name, None, columns, Rc::new(numbers));
    found.is_of_recording = true;
    found.is_sound = |own| {
        let forces = || own.chunks(3).map(Vector3::from_column_slice);
        let sum: Vector3<f64> = forces().sum();
        sum.norm() >= ONE_WAY * forces().map(|own| own.norm()).sum::<f64>()
    };
    Some(found)
}

/// Rows of the flange's Jacobian at the fine steps: joint by joint its three components.
fn jacobian(context: Context<'_>) -> Option<Vec<[Vec<f64>; 3]>> {
    let problem = context.problem;
    let bodies = &problem.arm.bodies;
    let flange = bodies.flange(0)?;
    let last = flange.body?;
    let (steps, joints) = (problem.states.steps(), problem.arm.joints());
    let mut found = vec![[0, 1, 2].map(|_| vec![0.0; steps]); joints];
    let mut work = problem.arm.work();
    let mut torque = vec![0.0; joints];
    let (mut q, still) = (vec![0.0; joints], vec![0.0; joints]);
    for step in 0..steps {
        for joint in 0..joints {
            q[joint] = problem.states.link.q[joint][step];
        }
        bodies.bias(&q, &still, &mut work, &mut torque).ok()?;
        let pose = work.pose(last)?;
        let point = pose.position_m + pose.rotation * flange.pose.position_m;
        let mut body = Some(last);
        while let Some(own) = body {
            let (joint, multiplier) = bodies.drive(own)?;
            let pose = work.pose(own)?;
            let axis: Vector3<f64> = pose.rotation * Vector3::z();
            let speed = match bodies.bodies()[own].joint {
                haptical_dynamics::Joint::Revolute(_) => axis.cross(&(point - pose.position_m)),
                haptical_dynamics::Joint::Prismatic(_) => axis,
            };
            for (component, value) in found[joint].iter_mut().zip(speed.iter()) {
                component[step] += multiplier * value;
            }
            body = bodies.bodies()[own].parent;
        }
    }
    Some(found)
}
