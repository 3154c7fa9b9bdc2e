//! The numbers of an arm that its torques depend on linearly, with their names.

use std::rc::Rc;

use haptical_model::JointType;

use crate::arm::PARAMETERS;
use crate::fit::base::slope;
use crate::fit::column::Column;
use crate::fit::problem::Problem;
use crate::identify::friction::{FrictionLaw, by_load};
use crate::thresholds::identify::DELAY_DIFFERENCE;

/// A number that torques depend on linearly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Number {
    /// One of the ten inertial parameters of a body ([`haptical_dynamics::Inertia::parameters`]).
    Body {
        body: usize,
        entry: usize,
    },
    Armature {
        joint: usize,
    },
    Viscous {
        joint: usize,
    },
    Coulomb {
        joint: usize,
    },
    Offset {
        joint: usize,
    },
    /// How Coulomb friction changes with the logarithm of the speed or the travel that its law has.
    Turnover {
        joint: usize,
    },
    /// How it changes with the time by which it leads the motion: what is late in friction alone is no delay of a log (A185).
    Lead {
        joint: usize,
    },
    /// Friction per what the joint carries.
    Load {
        joint: usize,
    },
    /// How long torques are logged before their positions, beyond what is taken off.
    Delay,
}

/// Short names of the inertial parameters of a body, its number behind them.
const ENTRIES: [&str; PARAMETERS] = [
    "m", "mx", "my", "mz", "ixx", "iyy", "izz", "ixy", "ixz", "iyz",
];
const UNITS: [&str; PARAMETERS] = [
    "kg", "kg m", "kg m", "kg m", "kg m^2", "kg m^2", "kg m^2", "kg m^2", "kg m^2", "kg m^2",
];
/// Order in which a body's parameters are offered: what a turning joint feels first comes first, so that masses and
/// the inertias along are those that are regrouped (Khalil and Dombre 2002, section 9.4.2).
const ORDER: [usize; PARAMETERS] = [6, 1, 2, 3, 4, 7, 8, 9, 5, 0];

impl Number {
    /// `m3`, `izz1`, `armature2`.
    pub(crate) fn name(self, problem: &Problem) -> String {
        match self {
            Self::Body { body, entry } => {
                let row = problem.arm.bodies.masses()[body].row;
                format!("{}{row}", ENTRIES[entry])
            }
            Self::Armature { joint } => format!("armature{}", joint + 1),
            Self::Viscous { joint } => format!("viscous{}", joint + 1),
            Self::Coulomb { joint } => format!("coulomb{}", joint + 1),
            Self::Offset { joint } => format!("offset{}", joint + 1),
            Self::Turnover { joint } => format!("turnover{}", joint + 1),
            Self::Lead { joint } => format!("lead{}", joint + 1),
            Self::Load { joint } => format!("load{}", joint + 1),
            Self::Delay => "delay".to_owned(),
        }
    }

    /// SI unit.
    pub(crate) fn unit(self, types: &[JointType]) -> &'static str {
        let pick = |joint: usize, turns, slides| match types[joint] {
            JointType::Revolute => turns,
            JointType::Prismatic => slides,
        };
        match self {
            Self::Body { entry, .. } => UNITS[entry],
            Self::Armature { joint } => pick(joint, "kg m^2", "kg"),
            Self::Viscous { joint } => pick(joint, "N m s/rad", "N s/m"),
            Self::Coulomb { joint } | Self::Offset { joint } | Self::Turnover { joint } => {
                pick(joint, "N m", "N")
            }
            Self::Lead { joint } => pick(joint, "N m s", "N s"),
            Self::Load { .. } => "1",
            Self::Delay => "s",
        }
    }

    /// Whether it is there so that others are right: it is told as no number of its own.
    pub(crate) fn is_beside(self) -> bool {
        matches!(
            self,
            Self::Delay | Self::Turnover { .. } | Self::Lead { .. }
        )
    }

    /// Value in the nominal model.
    pub(crate) fn nominal(self, problem: &Problem) -> f64 {
        match self {
            Self::Body { body, entry } => {
                problem.arm.bodies.masses()[body].inertia.parameters()[entry]
            }
            Self::Armature { joint } => problem.arm.armature[joint].unwrap_or(0.0),
            _ => 0.0,
        }
    }
}

/// All numbers of a problem; a body that is said to weigh nothing has none. Of drives alone there are no numbers of friction that no file holds,
/// and so no delay (A185). `loaded`: joints whose friction grows with their load.
pub(crate) fn numbers(
    problem: &Problem,
    (is_held, of_drives): (&[bool], bool),
    loaded: &[usize],
) -> Vec<Number> {
    let bodies = (0..problem.arm.body_count()).filter(|body| !is_held[*body]);
    let of_body = |body| (0..PARAMETERS).map(move |entry| Number::Body { body, entry });
    let joints = || problem.channels.iter().copied();
    bodies
        .flat_map(of_body)
        .chain(joints().map(|joint| Number::Armature { joint }))
        .chain(joints().map(|joint| Number::Viscous { joint }))
        .chain(joints().map(|joint| Number::Coulomb { joint }))
        .chain(joints().map(|joint| Number::Offset { joint }))
        .chain(joints().map(|joint| Number::Turnover { joint }))
        .chain(joints().map(|joint| Number::Lead { joint }))
        .chain(loaded.iter().map(|joint| Number::Load { joint: *joint }))
        .chain([Number::Delay])
        .filter(|own| !of_drives || !own.is_beside())
        .collect()
}

/// Order of preference: friction, offsets and delay first, which nothing else does; bodies from the base to the tip; armatures last.
pub(crate) fn order(numbers: &[Number]) -> Vec<usize> {
    let rank = |number: &Number| match *number {
        Number::Viscous { joint }
        | Number::Coulomb { joint }
        | Number::Load { joint }
        | Number::Offset { joint } => (0, joint),
        Number::Delay => (0, usize::MAX),
        Number::Body { body, entry } => {
            let place = ORDER.iter().position(|own| *own == entry).unwrap_or(0);
            (1, PARAMETERS * body + place)
        }
        Number::Armature { joint } => (2, joint),
        Number::Turnover { joint } | Number::Lead { joint } => (3, joint),
    };
    let mut order: Vec<usize> = (0..numbers.len()).collect();
    order.sort_by_key(|index| rank(&numbers[*index]));
    order
}

/// Whitened rows of every number; `early_s`: how long torques are taken to be logged before their positions.
pub(crate) fn columns(
    problem: &Problem,
    numbers: &[Number],
    friction: &[FrictionLaw],
    early_s: f64,
) -> Vec<Rc<Column>> {
    let motor = &problem.states.motor;
    let ones = vec![1.0; problem.states.steps()];
    let of = |joint: usize, signal: &[f64]| {
        (problem.of_joint(joint, signal)).unwrap_or_else(|| Column::All(Vec::new()))
    };
    let column = |number: &Number| match *number {
        Number::Body { body, entry } => {
            let mut unit = [0.0; PARAMETERS];
            unit[entry] = 1.0;
            problem.of_body(body, &unit)
        }
        Number::Armature { joint } => of(joint, &motor.ddq[joint]),
        Number::Viscous { joint } => of(joint, &motor.dq[joint]),
        Number::Coulomb { joint } => of(joint, &friction[joint].side(problem, joint)),
        Number::Turnover { joint } => of(joint, &friction[joint].by_turnover(problem, joint)),
        Number::Lead { joint } => {
            let side = friction[joint].side(problem, joint);
            of(joint, &slope(&side, problem))
        }
        Number::Load { joint } => {
            let side = friction[joint].side(problem, joint);
            of(joint, &by_load(problem, joint, &side))
        }
        Number::Offset { joint } => of(joint, &ones),
        Number::Delay => delay(problem, early_s),
    };
    numbers.iter().map(column).map(Rc::new).collect()
}

/// How recorded torques less the model change with the time that they are early, its sign turned: what is left is
/// `recorded(early) - columns x`, and a step of x makes it `recorded(early + x)`.
pub(crate) fn delay(problem: &Problem, early_s: f64) -> Column {
    let step_s = DELAY_DIFFERENCE * problem.samples.step_s;
    let ahead = problem.recorded(early_s + step_s);
    let behind = problem.recorded(early_s - step_s);
    let slopes = ahead.iter().zip(behind);
    Column::All(slopes.map(|(a, b)| (b - a) / (2.0 * step_s)).collect())
}
