//! The base model: what a sound arm's torques are made of besides its nominal rigid bodies.
//!
//! Torque = nominal bodies + plausible deviations of their numbers + armature + viscous friction and Coulomb friction + offset, with a
//! delay of a plausible size between torques and positions. docs/equations.md, A moving arm.

use std::rc::Rc;

use crate::arm::Deviation;
use crate::fit::column::Column;
use crate::fit::problem::Problem;
use crate::fit::system::System;
use crate::signal::states::States;
use crate::thresholds::fit::{BRISTLE_S, LEADS_S, LOUD_ARMATURE, OTHER_FRICTION, TURNOVERS};
use crate::thresholds::plausible;

/// What a column of the base model is.
#[derive(Debug, Clone)]
pub(crate) enum Term {
    /// Viscous friction of a joint, per its speed.
    Viscous { joint: usize },
    /// Coulomb friction of a joint.
    Coulomb { joint: usize },
    /// How its Coulomb friction builds up over a short travel after a reversal.
    Bristle,
    /// How its Coulomb friction changes with the logarithm of the speed within which it turns over.
    Turnover,
    /// How it changes with the time by which it leads the motion.
    Lead,
    /// Share of a joint's friction as the device's file has it; its place among what effects add.
    FileFriction { joint: usize, effect: usize },
    /// Armature of a joint; beyond the stated one, if one is stated.
    Armature { joint: usize },
    /// A body's deviation.
    Body(Deviation),
    /// Offset of a joint's torque.
    Offset,
    /// Delay: how long the torques are logged before their positions.
    Delay,
}

/// A column, and the standard deviation that is known of its coefficient.
#[derive(Debug, Clone)]
pub(crate) struct BaseColumn {
    pub(crate) term: Term,
    pub(crate) known_sd: Option<f64>,
    pub(crate) column: Rc<Column>,
}

impl BaseColumn {
    /// Limits of its coefficient, if there are any: those of what is known, and 0 and 1 of a share. Friction that the file does not have
    /// is an effect.
    pub(crate) fn limits(&self) -> Option<[f64; 2]> {
        let share = matches!(self.term, Term::FileFriction { .. }).then_some([0.0, 1.0]);
        let known = self.known_sd.map(|sd| plausible::LIMIT_SDS * sd);
        share.or(known.map(|limit| [-limit, limit]))
    }
}

/// Direction of a motion, smooth about rest.
pub(crate) fn sign(dq: &[f64], turnover: f64) -> Vec<f64> {
    dq.iter().map(|dq| libm::tanh(dq / turnover)).collect()
}

/// How Coulomb friction changes its direction with the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reversal {
    /// Speed within which it turns over.
    pub(crate) turnover: f64,
    /// How long before the motion it does.
    pub(crate) lead_s: f64,
}

impl Reversal {
    /// Its direction at the fine steps, smooth about rest.
    fn sign(self, problem: &Problem, joint: usize) -> Vec<f64> {
        let speed: Vec<f64> = self.speed(problem, joint).collect();
        sign(&speed, self.turnover)
    }

    /// The speed that it turns over with.
    fn speed(self, problem: &Problem, joint: usize) -> impl Iterator<Item = f64> + '_ {
        let motor = &problem.states.motor;
        let both = motor.dq[joint].iter().zip(&motor.ddq[joint]);
        both.map(move |(dq, ddq)| dq + self.lead_s * ddq)
    }
}

/// The base model of a problem.
#[derive(Debug, Clone)]
pub(crate) struct Base {
    pub(crate) columns: Vec<BaseColumn>,
    /// How each joint's Coulomb friction changes its direction.
    pub(crate) reversals: Vec<Reversal>,
    /// Size of each joint's Coulomb friction by a first fit; 0 before there is one.
    pub(crate) coulomb: Vec<f64>,
}

impl Base {
    /// The base model, Coulomb friction by what the torques show of it; `reversals`: where those are settled already. The friction of the
    /// device's file comes last: what there is of it beside its own is no reason for another reversal.
    pub(crate) fn new(problem: &Problem, reversals: Option<&[Reversal]>) -> Self {
        let mut base = Self::bare(problem, reversals);
        base.columns.extend(problem.file_effects.columns(problem));
        base
    }

    /// The base model of a device without friction in its file.
    fn bare(problem: &Problem, reversals: Option<&[Reversal]>) -> Self {
        let mut columns = viscous(problem);
        columns.extend(armatures(problem));
        columns.extend(bodies(problem));
        columns.extend(offsets(problem));
        columns.push(delay(problem, &problem.nominal_torque()));
        // of a body that no torque feels there is nothing to know
        columns.retain(|own| own.column.parts().1.iter().any(|value| *value != 0.0));
        let reversals = match reversals {
            Some(known) => known.to_vec(),
            None => settled_reversals(problem, &columns),
        };
        for joint in problem.channels.clone() {
            columns.extend(coulomb(problem, joint, reversals[joint]));
        }
        let coulomb = vec![0.0; problem.arm.joints()];
        let mut base = Self {
            columns,
            reversals,
            coulomb,
        };
        base.with_friction_in_delay(problem);
        base
    }

    /// The base model with rows weighted by how well they are known.
    pub(crate) fn weighted(problem: &mut Problem) -> Self {
        let first = Self::bare(problem, None);
        let solved = first.system().solve(&problem.recorded(0.0), &[]);
        let mut coulomb = vec![0.0; problem.arm.joints()];
        for (own, value) in first.columns.iter().zip(solved.solution) {
            if let Term::Coulomb { joint } = own.term {
                coulomb[joint] = value.abs();
            }
        }
        problem.allow_for_rest(&coulomb, &first.turnovers());
        Self {
            coulomb,
            ..Self::new(problem, None)
        }
    }

    /// Joints whose fitted friction differs from that of the device's file, in `rows` by more than noise; how many times that of the file
    /// it is.
    pub(crate) fn other_friction(&self, solution: &[f64], rows: usize) -> Vec<(usize, f64)> {
        let own = |joint: usize| {
            let columns = self.columns.iter().zip(solution);
            let of_joint = columns.filter_map(|(own, value)| match own.term {
                Term::FileFriction { joint: of, .. } => Some((of, own, [1.0, *value])),
                Term::Viscous { joint: of } | Term::Coulomb { joint: of } => {
                    Some((of, own, [0.0, *value]))
                }
                _ => None,
            });
            let of_joint: Vec<_> = of_joint.filter(|(of, ..)| *of == joint).collect();
            // products of the file's friction and of what is fitted, weighted as rows are
            let product = |a: usize, b: usize| -> f64 {
                let along = of_joint.iter().map(|(_, one, by)| {
                    let with = of_joint.iter();
                    by[a]
                        * with
                            .map(|(_, other, of)| of[b] * one.column.times(&other.column))
                            .sum::<f64>()
                });
                along.sum()
            };
            let (of_file, both, fitted) = (product(0, 0), product(0, 1), product(1, 1));
            let beyond = of_file - 2.0 * both + fitted;
            let least = (rows as f64).max(OTHER_FRICTION.powi(2) * of_file);
            (of_file > 0.0 && beyond > least).then(|| (joint, both / of_file))
        };
        (0..self.coulomb.len()).filter_map(own).collect()
    }

    /// Armatures with those that no file states as they are fitted, where one of them carries more noise of the positions into a torque than
    /// was allowed for.
    pub(crate) fn likely_armature(&self, problem: &Problem) -> Option<Vec<f64>> {
        let solved = self.system().solve(&problem.recorded(0.0), &[]);
        let mut likely = problem.arm.likely_armature.clone();
        let mut is_loud = false;
        for (own, value) in self.columns.iter().zip(&solved.solution) {
            let Term::Armature { joint } = own.term else {
                continue;
            };
            let channel = problem.channel_of(joint);
            let Some(channel) = channel.filter(|_| own.known_sd.is_none()) else {
                continue;
            };
            let noise = value.abs() * problem.states.acceleration_sd[joint];
            is_loud |= noise > LOUD_ARMATURE * problem.row_sd[channel];
            likely[joint] = value.abs();
        }
        is_loud.then_some(likely)
    }

    /// Speed within which each joint's friction turns over.
    pub(crate) fn turnovers(&self) -> Vec<f64> {
        self.reversals.iter().map(|own| own.turnover).collect()
    }

    /// Its columns as a system.
    pub(crate) fn system(&self) -> System {
        system_of(&self.columns)
    }

    /// The delay moves the friction too.
    fn with_friction_in_delay(&mut self, problem: &Problem) {
        let solved = self.system().solve(&problem.recorded(0.0), &[]);
        let torque = self.torque(problem, &solved.solution);
        let delays = self
            .columns
            .iter_mut()
            .filter(|own| matches!(own.term, Term::Delay));
        delays.for_each(|own| *own = delay(problem, &torque));
    }

    /// Torques of the model as fitted at the fine steps, deviations of bodies left out.
    pub(crate) fn torque(&self, problem: &Problem, solution: &[f64]) -> Vec<Vec<f64>> {
        let mut torque = problem.nominal_torque();
        let motor = &problem.states.motor;
        for (own, value) in self.columns.iter().zip(solution) {
            let (joint, signal) = match own.term {
                Term::Viscous { joint } => (joint, motor.dq[joint].clone()),
                Term::Coulomb { joint } => (joint, self.sign(problem, joint)),
                Term::FileFriction { joint, effect } => {
                    let states = &problem.states;
                    (joint, states.smoothed_added(&problem.samples, effect))
                }
                Term::Armature { joint } => (joint, motor.ddq[joint].clone()),
                _ => continue,
            };
            (torque[joint].iter_mut().zip(signal)).for_each(|(into, own)| *into += value * own);
        }
        torque
    }

    /// Columns whose coefficient nothing is known of.
    pub(crate) fn free(&self) -> usize {
        let free = self.columns.iter().filter(|own| own.known_sd.is_none());
        free.count()
    }

    /// Coulomb friction's direction of a joint at the fine steps.
    pub(crate) fn sign(&self, problem: &Problem, joint: usize) -> Vec<f64> {
        self.reversals[joint].sign(problem, joint)
    }
}

fn system_of(columns: &[BaseColumn]) -> System {
    let known: Vec<Option<f64>> = columns.iter().map(|own| own.known_sd).collect();
    let columns: Vec<Rc<Column>> = columns.iter().map(|own| Rc::clone(&own.column)).collect();
    System::new(&columns, &known)
}

fn viscous(problem: &Problem) -> Vec<BaseColumn> {
    let joints = problem.channels.iter().copied();
    let column = |joint: usize| {
        Some(BaseColumn {
            term: Term::Viscous { joint },
            known_sd: None,
            column: Rc::new(problem.of_joint(joint, &problem.states.motor.dq[joint])?),
        })
    };
    joints.filter_map(column).collect()
}

/// Of a joint whose device file states none, nothing is known: robot descriptions have no place for it.
fn armatures(problem: &Problem) -> Vec<BaseColumn> {
    let joints = problem.channels.iter().copied();
    let column = |joint: usize| {
        let stated = problem.arm.armature[joint];
        Some(BaseColumn {
            term: Term::Armature { joint },
            known_sd: stated.map(|own| (0.5 * plausible::ARMATURE * own).max(1e-9)),
            column: Rc::new(problem.of_joint(joint, &problem.states.motor.ddq[joint])?),
        })
    };
    joints.filter_map(column).collect()
}

fn bodies(problem: &Problem) -> Vec<BaseColumn> {
    let deviations = problem.arm.deviations().into_iter();
    let column = |deviation: Deviation| BaseColumn {
        column: Rc::new(problem.of_body(deviation.body, &deviation.parameters)),
        known_sd: Some(1.0),
        term: Term::Body(deviation),
    };
    deviations.map(column).collect()
}

fn offsets(problem: &Problem) -> Vec<BaseColumn> {
    let ones = vec![1.0; problem.states.steps()];
    let joints = problem.channels.iter().copied().enumerate();
    let column = |(channel, joint): (usize, usize)| {
        Some(BaseColumn {
            term: Term::Offset,
            known_sd: Some(
                0.5 * plausible::OFFSET_NOISES
                    * problem.reading_sd[channel].max(problem.row_sd[channel]),
            ),
            column: Rc::new(problem.of_joint(joint, &ones)?),
        })
    };
    joints.filter_map(column).collect()
}

fn delay(problem: &Problem, torque: &[Vec<f64>]) -> BaseColumn {
    let slopes: Vec<Vec<f64>> = torque.iter().map(|own| slope(own, problem)).collect();
    BaseColumn {
        term: Term::Delay,
        known_sd: Some(0.5 * plausible::DELAY_STEPS * problem.samples.step_s),
        column: Rc::new(problem.of_joints(&slopes)),
    }
}

/// What friction that builds up over a travel after each reversal is beside its direction: Dahl's
/// `dz = (sign(dq) - z) |dq| / x dt` (Dahl 1968) less the sign.
pub(crate) fn beyond_sign(states: &States, q: &[f64], sign: &[f64], travel: f64) -> Vec<f64> {
    let mut z = 0.0;
    (0..q.len())
        .map(|k| {
            // where a stretch begins nobody knows where the joint came from
            let follows = states.follows(k);
            let step = if follows { q[k] - q[k - 1] } else { 0.0 };
            z = if follows { z } else { 0.0 };
            // exact over a step in one direction
            let towards = if step == 0.0 { z } else { step.signum() };
            z = towards + (z - towards) * (-step.abs() / travel.max(1e-12)).exp();
            z - sign[k]
        })
        .collect()
}

/// Coulomb friction, how it changes with its turnover and its lead, and how it builds up.
fn coulomb(problem: &Problem, joint: usize, reversal: Reversal) -> Vec<BaseColumn> {
    let motor = &problem.states.motor;
    // derivative of the direction by its argument
    let steep = |speed: f64| {
        let x = speed / reversal.turnover;
        (x, libm::cosh(x.clamp(-300.0, 300.0)).powi(-2))
    };
    let by_turnover = reversal.speed(problem, joint).map(|speed| {
        let (x, steep) = steep(speed);
        -x * steep
    });
    let by_lead = reversal.speed(problem, joint).zip(&motor.ddq[joint]);
    let by_lead = by_lead.map(|(speed, ddq)| steep(speed).1 * ddq / reversal.turnover);
    let fastest = (motor.dq[joint].iter()).fold(0.0_f64, |most, dq| most.max(dq.abs()));
    let direction = reversal.sign(problem, joint);
    let bristle = beyond_sign(
        &problem.states,
        &motor.q[joint],
        &direction,
        BRISTLE_S * fastest,
    );
    let signals = [
        (Term::Bristle, bristle),
        (Term::Coulomb { joint }, direction),
        (Term::Turnover, by_turnover.collect()),
        (Term::Lead, by_lead.collect()),
    ];
    let column = |(term, signal): (Term, Vec<f64>)| {
        Some(BaseColumn {
            term,
            known_sd: None,
            column: Rc::new(problem.of_joint(joint, &signal)?),
        })
    };
    signals.into_iter().filter_map(column).collect()
}

/// Derivative in time of a signal at the fine steps.
pub(crate) fn slope(signal: &[f64], problem: &Problem) -> Vec<f64> {
    let times = &problem.states.time_s;
    let last = signal.len() - 1;
    // across a break between pieces: the side that is near
    let near = |a: usize, b: usize| {
        times[b] - times[a] > 0.0 && times[b] - times[a] < 1.5 * problem.states.fine_s
    };
    (0..signal.len())
        .map(|k| {
            let before = if k > 0 && near(k - 1, k) { k - 1 } else { k };
            let after = if k < last && near(k, k + 1) { k + 1 } else { k };
            match after > before {
                true => (signal[after] - signal[before]) / (times[after] - times[before]),
                false => 0.0,
            }
        })
        .collect()
}

/// The reversal of each joint's friction that explains most of what the other columns and the other joints' friction leave: its turnover
/// first, then its lead, then both again.
fn settled_reversals(problem: &Problem, columns: &[BaseColumn]) -> Vec<Reversal> {
    let system = system_of(columns);
    let solved = system.solve(&problem.recorded(0.0), &[]);
    let middle = Reversal {
        turnover: TURNOVERS[TURNOVERS.len() / 2],
        lead_s: 0.0,
    };
    let mut reversals = vec![middle; problem.arm.joints()];
    let of = |joint: usize, reversal: Reversal| {
        let column = problem.of_joint(joint, &reversal.sign(problem, joint));
        column.map(Rc::new)
    };
    for round in 0..2 {
        let known = reversals.clone();
        for &joint in &problem.channels {
            let beside = problem
                .channels
                .iter()
                .filter(|other| round > 0 && **other != joint);
            let beside: Vec<Rc<Column>> = beside
                .filter_map(|other| of(*other, known[*other]))
                .collect();
            let gain = |reversal: Reversal| {
                let mut columns = beside.clone();
                columns.extend(of(joint, reversal));
                solved.gain(&columns, &system.across(&columns)).nats
            };
            let best = |all: &mut dyn Iterator<Item = Reversal>| {
                let all = all.map(|own| (gain(own), own));
                all.reduce(|a, b| if b.0 > a.0 { b } else { a })
            };
            let lead_s = known[joint].lead_s;
            let turnovers = TURNOVERS.map(|turnover| Reversal { turnover, lead_s });
            if let Some((_, found)) = best(&mut turnovers.into_iter()) {
                let leads = LEADS_S.map(|lead_s| Reversal { lead_s, ..found });
                reversals[joint] = best(&mut leads.into_iter()).map_or(found, |own| own.1);
            }
        }
    }
    reversals
}
