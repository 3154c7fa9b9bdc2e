//! Inertias, friction, armatures, offsets and the delay of an arm from a log of its positions and torques.
//!
//! docs/equations.md, Identification of a moving arm.

mod answer;
mod bias;
mod chosen;
mod combinations;
mod device;
mod estimate;
mod feasible;
mod fit;
mod friction;
mod instruments;
mod loaded;
mod numbers;
mod predict;
mod result;
mod shape;

use haptical_model::{Device, Recording};

use crate::MotionError;
use crate::arm::{Arm, PARAMETERS};
use crate::fit::problem::{Problem, Reading};

use answer::Answer;
use bias::{Known, of_noise};
use chosen::{Chosen, with_instruments};
use combinations::Combinations;
use estimate::{Estimate, least_squares};
use feasible::{Feasible, Kind, nearest};
use fit::settle;
use loaded::Loaded;
use numbers::{Number, numbers};
use predict::Numbers;
use shape::Shape;

use crate::thresholds::identify::{
    ARMATURE_SD, ASSUMED_BODY_SD, GIVEN_BODY_SD, LOOSE_SD, POSITION_NOISE,
};
pub use bias::NOISE_SEED;
pub use device::with_dynamics;
pub use friction::FrictionLaw;
pub use instruments::Instruments;
pub use predict::{Residual, torques_left};
pub use result::{
    BaseParameter, BodyDynamics, Dynamics, Estimated, JointDynamics, stacked_percent,
};

/// Identifies the dynamics of a device from a recording; `validate`: one that is predicted and not fitted; `edge_hz`: the band, where
/// it is not for the log to say.
///
/// # Errors
/// [`MotionError`] for a device without rows, and for a recording without torques, time or motion, or too slow or too short.
pub fn identify_dynamics(
    device: &Device,
    recording: &Recording,
    validate: Option<&Recording>,
    edge_hz: Option<f64>,
) -> Result<Dynamics, MotionError> {
    identify(device, (recording, validate), edge_hz, Scope::ALL)
}

/// Identifies what a device file holds of friction, armatures and offsets of a device's drives; its bodies are those of its file.
///
/// # Errors
/// As [`identify_dynamics`].
pub fn identify_drives(device: &Device, recording: &Recording) -> Result<Dynamics, MotionError> {
    identify(device, (recording, None), None, Scope::DRIVES)
}

/// What is identified, and how.
#[derive(Debug, Clone, Copy)]
struct Scope {
    /// Drives alone.
    of_drives: bool,
    /// Whether it is asked what the noise of the positions does.
    asks_for_bias: bool,
}

impl Scope {
    const ALL: Self = Self {
        of_drives: false,
        asks_for_bias: true,
    };
    const DRIVES: Self = Self {
        of_drives: true,
        ..Self::ALL
    };
}

/// By least squares alone, as fits are compared with each other: whether they bend by the noise of the positions is not asked.
///
/// # Errors
/// As [`identify_dynamics`].
pub fn compared_dynamics(
    device: &Device,
    recording: &Recording,
    of_drives: bool,
) -> Result<Dynamics, MotionError> {
    let scope = Scope {
        of_drives,
        asks_for_bias: false,
    };
    identify(device, (recording, None), None, scope)
}

fn identify(
    device: &Device,
    logs: (&Recording, Option<&Recording>),
    edge_hz: Option<f64>,
    scope: Scope,
) -> Result<Dynamics, MotionError> {
    let (first, loaded) = pass(device, logs, (edge_hz, scope), &Loaded::default())?;
    // what a joint carries is by the bodies of a first fit
    match loaded.joints.is_empty() {
        true => Ok(first),
        false => Ok(pass(device, logs, (Some(first.edge_hz), scope), &loaded)?.0),
    }
}

/// One fit, and which joints it shows to have friction by their load, if none was asked for.
fn pass(
    device: &Device,
    (recording, validate): (&Recording, Option<&Recording>),
    (edge_hz, scope): (Option<f64>, Scope),
    loaded: &Loaded,
) -> Result<(Dynamics, Loaded), MotionError> {
    let of_drives = scope.of_drives;
    let arm = arm(device, of_drives)?;
    check(&arm, recording)?;
    let reading = Reading {
        edge_hz,
        sets_right: true,
        noise_share: POSITION_NOISE,
        ..Reading::default()
    };
    let mut problem = Problem::new(arm.clone(), recording, reading.clone())?;
    let edge_hz = problem.states.pass.edge_hz;
    let reading = Reading {
        edge_hz: Some(edge_hz),
        // a log with the same times has no other rows to be set right
        sets_right: problem.samples.sampling.is_some(),
        ..reading.clone()
    };
    let mut is_held = held(device, &arm);
    is_held.iter_mut().for_each(|own| *own |= of_drives);
    if let Some(own) = &loaded.arm {
        problem.carry(own)?;
    }
    let numbers = numbers(&problem, (&is_held, of_drives), &loaded.joints);
    let settled = settle(&mut problem, &numbers)?;
    let known = Known {
        arm: &arm,
        recording,
        reading: reading.clone(),
        numbers: &numbers,
        settled: &settled,
        loaded,
    };
    let columns = known.columns(&problem);
    let target = problem.recorded(settled.early_s);
    let rows = problem.states.rows();
    let base = Combinations::new(&numbers, &columns, &target, rows)?;
    let plain = least_squares(&base, &columns, &target, rows)?;
    let position_sd = problem.states.position_sd.clone();
    let (mut bias, mut with) = (None, None);
    if scope.asks_for_bias {
        bias = of_noise(&known, &base, plain.values.as_slice(), &problem.states).ok();
        with = with_instruments(&known, &problem, &base, (&columns, &target));
    }
    let chosen = Chosen::new(plain, bias, with);
    let (estimate, bias) = (&chosen.estimate, chosen.bias.as_deref());
    let warnings = chosen.warning(&problem, (&numbers, &base));
    let shapes = shapes(&arm, &is_held)?;
    let feasible = feasible(&problem, (&numbers, &base), estimate, &shapes)?;
    let by_base = base.of_numbers(estimate.values.as_slice());
    let by = Numbers {
        numbers: &numbers,
        settled: &settled,
        loaded,
        feasible: &feasible.values,
        base: &by_base,
    };
    let validated = validate.map(|own| {
        let reading = Reading {
            sets_right: true,
            ..reading
        };
        let found = by.on(&arm, own, reading);
        found.map_err(|error| error.to_string())
    });
    let answer = Answer {
        problem: &problem,
        numbers: &numbers,
        settled: &settled,
        feasible: &feasible,
        shapes: &shapes,
    };
    let found = Dynamics {
        joints: answer.joints(),
        bodies: answer.bodies(&is_held),
        base: answer.base(device, (&base, estimate), bias),
        unseen: base
            .rank
            .zero
            .iter()
            .filter(|own| !numbers[**own].is_beside())
            .map(|own| numbers[*own].name(&problem))
            .collect(),
        delay_s: answer.delay(&base, estimate),
        residuals: by.residuals(&mut problem.clone()),
        validated,
        instruments: chosen.instruments,
        position_sd,
        edge_hz,
        rows,
        inflation: estimate.inflation,
        warnings: warnings
            .into_iter()
            .chain(problem.states.of_stretches.clone())
            .collect(),
    };
    if loaded.arm.is_some() {
        return Ok((found, Loaded::default()));
    }
    let shown = Arm::new(&with_dynamics(device, &found)?)?;
    let loaded = Loaded::shown(&known, &problem, shown, estimate.inflation)?;
    Ok((found, loaded))
}

/// The arm whose offsets and delay are found anew, of drives alone the offsets.
fn arm(device: &Device, of_drives: bool) -> Result<Arm, MotionError> {
    let known = Arm::new(device)?;
    let early_s = known.early_s.iter();
    Ok(Arm {
        offset: vec![0.0; device.joints.len()],
        early_s: early_s
            .map(|own| if of_drives { *own } else { 0.0 })
            .collect(),
        ..known
    })
}

/// What a recording of joints of this arm must have.
fn check(arm: &Arm, recording: &Recording) -> Result<(), MotionError> {
    let (joints, columns) = (arm.joints(), recording.joint.len());
    if columns != joints {
        return Err(MotionError::Missing {
            what: format!("a column of each of the {joints} joints (the log has {columns})"),
            why: "every joint moves the links behind it",
        });
    }
    Ok(())
}

/// Bodies that the file says weigh nothing.
fn held(device: &Device, arm: &Arm) -> Vec<bool> {
    let masses = arm.bodies.masses().iter();
    masses
        .map(|own| {
            let body = device.bodies.get(own.row).copied().flatten();
            body.is_some_and(|body| body.mass_kg <= 0.0)
        })
        .collect()
}

/// Shapes of the bodies that have a mass, each with its body.
fn shapes(arm: &Arm, is_held: &[bool]) -> Result<Vec<(usize, Shape)>, MotionError> {
    let bodies = (0..arm.body_count()).filter(|body| !is_held[*body]);
    let shape = |body: usize| {
        let own = &arm.bodies.masses()[body];
        let sd = match own.has_mass && own.has_inertia {
            true => GIVEN_BODY_SD,
            false => ASSUMED_BODY_SD,
        };
        let shape = Shape::new(&own.inertia, sd).ok_or_else(|| {
            MotionError::Fit(format!("row {} has no mass that a body can have", own.row))
        })?;
        Ok((body, shape))
    };
    bodies.map(shape).collect()
}

/// The feasible set that has the base parameters.
fn feasible(
    problem: &Problem,
    (numbers, base): (&[Number], &Combinations),
    estimate: &Estimate,
    shapes: &[(usize, Shape)],
) -> Result<Feasible, MotionError> {
    let arm = &problem.arm;
    let largest = |column: &[f64]| {
        column
            .iter()
            .fold(1e-6_f64, |most, own| most.max(own.abs()))
    };
    let torque = |joint: usize| {
        let own = problem.states.torque(&problem.samples, joint, 0.0);
        (haptical_linalg::dot(&own, &own) / own.len() as f64)
            .sqrt()
            .max(1e-9)
    };
    let motor = &problem.states.motor;
    let kind = |number: &Number| match *number {
        Number::Body { body, entry } => Kind::Body {
            shape: shapes.iter().position(|own| own.0 == body).unwrap_or(0),
            entry,
        },
        Number::Armature { joint } => {
            let stated = arm.armature[joint].unwrap_or(0.0);
            let scale = torque(joint) / largest(&motor.ddq[joint]);
            Kind::Own {
                least: -stated,
                known_sd: Some(if stated > 0.0 {
                    ARMATURE_SD * stated
                } else {
                    scale
                }),
            }
        }
        Number::Viscous { joint } => Kind::Own {
            least: 0.0,
            known_sd: Some(LOOSE_SD * torque(joint) / largest(&motor.dq[joint])),
        },
        Number::Coulomb { joint } => Kind::Own {
            least: 0.0,
            known_sd: Some(LOOSE_SD * torque(joint)),
        },
        Number::Turnover { joint } | Number::Lead { joint } => Kind::Own {
            least: f64::NEG_INFINITY,
            known_sd: Some(LOOSE_SD * torque(joint)),
        },
        Number::Load { .. } => Kind::Own {
            least: 0.0,
            known_sd: Some(LOOSE_SD),
        },
        Number::Offset { joint } => Kind::Own {
            least: f64::NEG_INFINITY,
            known_sd: Some(LOOSE_SD * torque(joint)),
        },
        Number::Delay => Kind::Own {
            least: f64::NEG_INFINITY,
            known_sd: Some(LOOSE_SD * problem.samples.step_s),
        },
    };
    let kinds: Vec<Kind> = numbers.iter().map(kind).collect();
    let nominal: Vec<[f64; PARAMETERS]> = shapes
        .iter()
        .map(|own| arm.bodies.masses()[own.0].inertia.parameters())
        .collect();
    let shapes: Vec<Shape> = shapes.iter().map(|own| own.1.clone()).collect();
    // rows with a memory say less than so many independent ones
    let root = &estimate.root / estimate.inflation.sqrt();
    nearest(
        (&shapes, &nominal),
        &kinds,
        &base.map,
        (&root, &estimate.values),
    )
}
