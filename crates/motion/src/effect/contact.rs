//! A force on the flange, or on what it holds, for a part of the log.

use std::ops::Range;
use std::rc::Rc;

use nalgebra::{Matrix3, Vector3};

use super::{Candidate, Context, Effect, Finer};
use crate::fit::trimmed::{Outside, outside};
use crate::thresholds::effect::{
    CONTACT_NODE_ROWS, FARTHEST_M, FELT_BY_TWO, MOST_CONTACT_NODES, ONE_WAY, PUSH_LAW_SD,
    TORQUES_OF_MANY,
};

pub(crate) const EFFECT: Effect = Effect::new("contact", candidates);

/// Numbers of the point that is touched.
const OF_POINT: usize = 3;

/// When something pushes: the nodes of its force's course.
#[derive(Clone)]
struct Course {
    nodes: Vec<f64>,
    apart_s: f64,
    /// Share of the log.
    share: f64,
    /// What it takes to say when it begins and ends, each time that it does \[nats\].
    of_ends: f64,
}

/// Three components of a force on the flange, straight between nodes, at the times that do not agree with the others.
fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    let Some(outside) = outside(context.problem, context.base).filter(is_felt_by_two) else {
        return Vec::new();
    };
    let problem = context.problem;
    let kinds = match problem.at_tool && problem.channels.len() >= TORQUES_OF_MANY {
        true => 2,
        false => 1,
    };
    let of_kind = |kind| {
        Course::new(
            context,
            &outside.rows,
            (CONTACT_NODE_ROWS[kind], MOST_CONTACT_NODES[kind]),
        )
    };
    let courses: Vec<Course> = (0..kinds).map(of_kind).collect();
    let Some(geometry) = geometry(context).map(Rc::new) else {
        return Vec::new();
    };
    let make = |course| {
        let known = (Rc::new(course), Rc::clone(&geometry));
        at(context, &known, Vector3::zeros(), &[])
    };
    courses.into_iter().map(make).collect()
}

fn is_felt_by_two(outside: &Outside) -> bool {
    let mut sizes = outside.squares.clone();
    sizes.sort_by(|a, b| b.total_cmp(a));
    let second = sizes.get(1);
    second.is_some_and(|second| *second >= FELT_BY_TWO * sizes[0])
}

/// Logarithm of the number of ways in which so many stretches may lie among the rows, by n choose k < (n e / k)^k (Rissanen 1978 on
/// what a choice made by the data costs).
fn of_ends(outside: &[bool]) -> f64 {
    let is_end = |own: &&[bool]| own[0] != own[1];
    let ends = outside.windows(2).filter(is_end).count().max(1) as f64;
    ends * (1.0 + (outside.len() as f64 / ends).ln())
}

impl Course {
    fn new(context: Context<'_>, outside: &[bool], (rows, most): (f64, usize)) -> Self {
        let states = &context.problem.states;
        let count = outside.iter().filter(|own| **own).count() as f64;
        let row_s = states.pass.row_s();
        let apart_s = (rows * row_s).max(count * row_s / most as f64);
        let mut nodes: Vec<f64> = Vec::new();
        for (row, _) in outside.iter().enumerate().filter(|(_, own)| **own) {
            let time = states.time_s[states.centre[row]];
            for time in [time - 2.0 * row_s, time, time + 2.0 * row_s] {
                // on one grid for the whole log
                let node = (time / apart_s).round() * apart_s;
                if nodes.last().is_none_or(|last| node > last + 0.5 * apart_s) {
                    nodes.push(node);
                }
            }
        }
        Self {
            nodes,
            apart_s,
            share: count / outside.len() as f64,
            of_ends: of_ends(outside),
        }
    }

    /// Fine steps that a node is part of.
    fn steps(&self, node: f64, times: &[f64]) -> Range<usize> {
        let from = times.partition_point(|time| *time <= node - self.apart_s);
        from..times.partition_point(|time| *time < node + self.apart_s)
    }
}

impl Course {
    /// Weight of a node at a time.
    fn hat(&self, node: f64, time_s: f64) -> f64 {
        (1.0 - ((time_s - node) / self.apart_s).abs()).max(0.0)
    }

    /// The force at a time, of three components a node.
    fn force(&self, forces: &[f64], time_s: f64) -> Vector3<f64> {
        let own = self.nodes.iter().zip(forces.chunks_exact(3));
        own.map(|(node, own)| Vector3::from_column_slice(own) * self.hat(*node, time_s))
            .sum()
    }
}

/// The force pushes at a point that is `point_m` beside the flange, in the frame of the last body. It is linear in the force, and about a
/// force in how far that point is off: the last three columns, zero where no force is known yet.
fn at<'c>(
    context: Context<'c>,
    known: &(Rc<Course>, Rc<Geometry>),
    point_m: Vector3<f64>,
    forces: &[f64],
) -> Candidate<'c> {
    let problem = context.problem;
    let (course, geometry) = known;
    let times = &problem.states.time_s;
    let joints = problem.arm.joints();
    let levers: Vec<Vector3<f64>> = geometry.turn.iter().map(|own| own * point_m).collect();
    let mut columns = Vec::new();
    for node in &course.nodes {
        let steps = course.steps(*node, times);
        for axis in 0..3 {
            let at = |joint: usize, step: usize| {
                let speed = geometry.speed(joint, step, &levers[step]);
                -course.hat(*node, times[step]) * speed[axis]
            };
            let signal = |joint: usize| steps.clone().map(|step| at(joint, step)).collect();
            columns.push(problem.of_joints_at(&steps, signal));
        }
    }
    let pushes: Vec<Vector3<f64>> = (times.iter())
        .map(|time| course.force(forces, *time))
        .collect();
    for axis in 0..OF_POINT {
        let signal = |joint: usize| -> Vec<f64> {
            let moment = |(step, push): (usize, &Vector3<f64>)| {
                let lever: Vector3<f64> = geometry.turn[step].column(axis).into();
                -geometry.axis[joint][step].dot(&lever.cross(push))
            };
            pushes.iter().enumerate().map(moment).collect()
        };
        columns.push(problem.of_joints(&(0..joints).map(signal).collect::<Vec<_>>()));
    }
    let share = course.share;
    let numbers = move |own: &[f64]| {
        let force = forces_of(own).map(|own| own.norm());
        vec![("share", share), ("force_n", force.fold(0.0, f64::max))]
    };
    let mut found = Candidate::new(EFFECT.name, None, columns, Rc::new(numbers)).in_spans();
    (found.is_of_recording, found.law_sd) = (true, PUSH_LAW_SD);
    found.of_noise = course.of_ends;
    found.is_sound = |own| {
        let sum: Vector3<f64> = forces_of(own).sum();
        sum.norm() >= ONE_WAY * forces_of(own).map(|own| own.norm()).sum::<f64>()
    };
    let known = known.clone();
    if !problem.at_tool {
        return found;
    }
    found.finer = Finer::About(Rc::new(move |own| {
        let (forces, off) = own.split_at(own.len() - OF_POINT);
        let point_m = (point_m + Vector3::from_column_slice(off)).cap_magnitude(FARTHEST_M);
        Some(at(context, &known, point_m, forces))
    }));
    found
}

/// Forces at the nodes.
fn forces_of(coefficients: &[f64]) -> impl Iterator<Item = Vector3<f64>> {
    let all = coefficients[..coefficients.len() - OF_POINT].chunks_exact(3);
    all.map(Vector3::from_column_slice)
}

/// Where the flange and the joints are at the fine steps.
struct Geometry {
    /// How fast each joint moves the flange, and the axis about which it turns it: zero of one that slides.
    flange: Vec<Vec<Vector3<f64>>>,
    axis: Vec<Vec<Vector3<f64>>>,
    /// Rotation of the last body.
    turn: Vec<Matrix3<f64>>,
}

impl Geometry {
    /// How fast a joint moves a point that is a lever from the flange.
    fn speed(&self, joint: usize, step: usize, lever: &Vector3<f64>) -> Vector3<f64> {
        self.flange[joint][step] + self.axis[joint][step].cross(lever)
    }
}

fn geometry(context: Context<'_>) -> Option<Geometry> {
    let problem = context.problem;
    let bodies = &problem.arm.bodies;
    let flange = bodies.flange(0)?;
    let last = flange.body?;
    let (steps, joints) = (problem.states.steps(), problem.arm.joints());
    let none = || vec![vec![Vector3::zeros(); steps]; joints];
    let mut found = Geometry {
        flange: none(),
        axis: none(),
        turn: Vec::with_capacity(steps),
    };
    let mut work = problem.arm.work();
    let mut torque = vec![0.0; joints];
    let (mut q, still) = (vec![0.0; joints], vec![0.0; joints]);
    for step in 0..steps {
        for joint in 0..joints {
            q[joint] = problem.states.link.q[joint][step];
        }
        bodies.bias(&q, &still, &mut work, &mut torque).ok()?;
        let pose = work.pose(last)?;
        found.turn.push(pose.rotation);
        let point = pose.position_m + pose.rotation * flange.pose.position_m;
        let mut body = Some(last);
        while let Some(own) = body {
            let (joint, multiplier) = bodies.drive(own)?;
            let pose = work.pose(own)?;
            let axis: Vector3<f64> = pose.rotation * Vector3::z() * multiplier;
            match bodies.bodies()[own].joint {
                haptical_dynamics::Joint::Revolute(_) => {
                    found.flange[joint][step] += axis.cross(&(point - pose.position_m));
                    found.axis[joint][step] += axis;
                }
                haptical_dynamics::Joint::Prismatic(_) => found.flange[joint][step] += axis,
            }
            body = bodies.bodies()[own].parent;
        }
    }
    Some(found)
}
