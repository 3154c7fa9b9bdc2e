//! Inertias, friction, armatures, offsets and the delay of an arm from a log of its positions and torques.
//!
//! docs/equations.md, Identification of a moving arm.

mod bias;
mod combinations;
mod device;
mod estimate;
mod feasible;
mod fit;
mod friction;
mod instruments;
mod numbers;
mod predict;
mod result;

use std::rc::Rc;

use haptical_model::{Device, JointType, Recording};
use nalgebra::DVector;

use crate::MotionError;
use crate::arm::{Arm, PARAMETERS};
use crate::column::Column;
use crate::problem::{Problem, Reading};

use bias::{Known, of_noise, position_sds};
use combinations::Combinations;
use estimate::{Estimate, instrumented, least_squares};
use feasible::{ASSUMED_SD, Feasible, GIVEN_SD, Kind, Shape, nearest};
use fit::{Settled, settle};
use numbers::{Number, numbers};
use predict::Numbers;

pub use device::with_dynamics;
pub use friction::FrictionLaw;
pub use instruments::Instruments;
pub use predict::Residual;
pub use result::{
    BaseParameter, BodyDynamics, Dynamics, Estimated, JointDynamics, stacked_percent,
};

/// Standard deviation of friction and offsets that is known beforehand, in torques' root mean squares: nothing.
const LOOSE: f64 = 1e3;
/// Share of a torque that the noise of the positions may make up within the band.
const NOISE_SHARE: f64 = 0.01;
/// Share of a standard deviation from which a bias is worth the larger intervals of instruments.
const BIAS_MATTERS: f64 = 0.25;
/// Instruments by which the median number is this many times less certain than by least squares say too little.
const WIDER: f64 = 3.0;
/// Standard deviation of an armature that is known beforehand, as a share of the stated one.
const ARMATURE_SD: f64 = 1.0;

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
    // offsets and delay are found anew
    let arm = Arm {
        offset: vec![0.0; device.joints.len()],
        early_s: vec![0.0; device.joints.len()],
        ..Arm::new(device)?
    };
    check(&arm, recording)?;
    let reading = Reading {
        edge_hz,
        sets_right: true,
        has_memory: false,
        noise_share: NOISE_SHARE,
    };
    let mut problem = Problem::new(arm.clone(), recording, reading)?;
    let edge_hz = problem.states.pass.edge_hz;
    let reading = Reading {
        edge_hz: Some(edge_hz),
        ..reading
    };
    let is_held = held(device, &arm);
    let numbers = numbers(&problem, &is_held);
    let settled = settle(&mut problem, &numbers);
    let known = Known {
        arm: &arm,
        recording,
        reading,
        numbers: &numbers,
        settled: &settled,
    };
    let columns = known.columns(&problem);
    let target = problem.recorded(settled.early_s);
    let rows = problem.states.rows();
    let base = Combinations::new(&numbers, &columns, &target, rows)?;
    let plain = least_squares(&base, &columns, &target, rows)?;
    let position_sd = position_sds(&problem);
    let bias = of_noise(&known, &base, plain.values.as_slice(), &position_sd).ok();
    let with = with_instruments(&known, &problem, &base, (&columns, &target));
    let chosen = Chosen::new(plain, bias, with);
    let (estimate, bias) = (&chosen.estimate, chosen.bias.as_deref());
    let warnings = chosen.warning(&problem, (&numbers, &base));
    let shapes = shapes(&arm, &is_held)?;
    let feasible = feasible(&problem, (&numbers, &base), estimate, &shapes)?;
    let mut by_base = vec![0.0; numbers.len()];
    for (value, column) in estimate.values.iter().zip(base.kept()) {
        by_base[*column] = *value;
    }
    let by = Numbers {
        numbers: &numbers,
        settled: &settled,
        feasible: &feasible.values,
        base: &by_base,
    };
    let validated = validate.map(|own| {
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
    Ok(Dynamics {
        joints: answer.joints(),
        bodies: answer.bodies(&is_held),
        base: answer.base(device, (&base, estimate), bias),
        unseen: base
            .rank
            .zero
            .iter()
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
        warnings: warnings.into_iter().collect(),
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
            true => GIVEN_SD,
            false => ASSUMED_SD,
        };
        let shape = Shape::new(&own.inertia, sd).ok_or_else(|| {
            MotionError::Fit(format!("row {} has no mass that a body can have", own.row))
        })?;
        Ok((body, shape))
    };
    bodies.map(shape).collect()
}

/// The fit with instruments, where there are some that span the motion.
fn with_instruments(
    known: &Known<'_>,
    problem: &Problem,
    base: &Combinations,
    (columns, target): (&[Rc<Column>], &[f64]),
) -> Option<(Estimate, Instruments)> {
    let (twin, instruments) = instruments::twin(known.recording, &problem.samples)?;
    let twin = known.problem(&twin).ok()?;
    if twin.states.rows() != problem.states.rows() {
        return None;
    }
    let pick = |own: &[Rc<Column>]| -> Vec<Rc<Column>> {
        base.kept()
            .iter()
            .map(|column| Rc::clone(&own[*column]))
            .collect()
    };
    let mut of_twin = known.columns(&twin);
    // the slope of the torques in time is no regressor of positions
    let delay = known.numbers.iter().position(|own| *own == Number::Delay)?;
    of_twin[delay] = Rc::clone(&columns[delay]);
    let rows = problem.states.rows();
    let found = instrumented(&pick(columns), &pick(&of_twin), target, rows).ok()?;
    Some((found, instruments))
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
            known_sd: Some(LOOSE * torque(joint) / largest(&motor.dq[joint])),
        },
        Number::Coulomb { joint } => Kind::Own {
            least: 0.0,
            known_sd: Some(LOOSE * torque(joint)),
        },
        Number::Offset { joint } => Kind::Own {
            least: f64::NEG_INFINITY,
            known_sd: Some(LOOSE * torque(joint)),
        },
        Number::Delay => Kind::Own {
            least: f64::NEG_INFINITY,
            known_sd: Some(LOOSE * problem.samples.step_s),
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

/// Standard deviations by instruments over those by least squares: the median.
fn wider(with: &Estimate, plain: &Estimate) -> f64 {
    let mut ratios: Vec<f64> = (with.sd.iter().zip(&plain.sd))
        .map(|(with, plain)| with / plain)
        .collect();
    ratios.sort_by(f64::total_cmp);
    ratios
        .get(ratios.len() / 2)
        .copied()
        .unwrap_or(f64::INFINITY)
}

/// Least squares, or instruments where the noise of the positions matters and they say enough.
struct Chosen {
    estimate: Estimate,
    instruments: Option<Instruments>,
    /// What the noise is taken to have changed; none with instruments.
    bias: Option<Vec<f64>>,
    /// Why there are no instruments.
    why: &'static str,
}

impl Chosen {
    fn new(plain: Estimate, bias: Option<Vec<f64>>, with: Option<(Estimate, Instruments)>) -> Self {
        let share = |(bias, sd): (&f64, &f64)| bias.abs() / sd;
        let matters = bias.as_ref().is_none_or(|own| {
            let mut shares = own.iter().zip(&plain.sd).map(share);
            shares.any(|own| own > BIAS_MATTERS)
        });
        let why = match &with {
            None => "the log neither repeats its motion nor has commands",
            Some(_) if !matters => "it is too small for instruments to help",
            Some((own, _)) if wider(own, &plain) > WIDER => {
                "the motion repeats itself, or follows its commands, too loosely to keep it out"
            }
            Some(_) => "",
        };
        match with {
            Some((estimate, instruments)) if why.is_empty() => Self {
                estimate,
                instruments: Some(instruments),
                bias: None,
                why,
            },
            _ => Self {
                estimate: plain,
                instruments: None,
                bias,
                why,
            },
        }
    }

    /// What is said where nothing keeps the noise of the positions out.
    fn warning(
        &self,
        problem: &Problem,
        (numbers, base): (&[Number], &Combinations),
    ) -> Option<String> {
        if self.instruments.is_some() {
            return None;
        }
        let without = format!("the bias of noisy positions is not excluded: {}", self.why);
        let Some(bias) = &self.bias else {
            return Some(format!("{without}; its size could not be estimated"));
        };
        let share = |k: usize| bias[k].abs() / self.estimate.sd[k];
        let largest = (0..bias.len()).max_by(|a, b| share(*a).total_cmp(&share(*b)))?;
        Some(format!(
            "{without}; by the encoders' noise it is about {:.2} standard deviations at most (of {})",
            share(largest),
            numbers[base.kept()[largest]].name(problem)
        ))
    }
}

/// From coordinates of the fit to an answer.
struct Answer<'a> {
    problem: &'a Problem,
    numbers: &'a [Number],
    settled: &'a Settled,
    feasible: &'a Feasible,
    shapes: &'a [(usize, Shape)],
}

impl Answer<'_> {
    fn of(&self, number: Number) -> Estimated {
        let place = self.numbers.iter().position(|own| *own == number);
        place.map_or(
            Estimated {
                value: 0.0,
                sd: 0.0,
            },
            |place| Estimated {
                value: number.nominal(self.problem) + self.feasible.values[place],
                sd: self.feasible.sd[place],
            },
        )
    }

    fn joints(&self) -> Vec<JointDynamics> {
        let of = |joint: &usize| {
            let joint = *joint;
            JointDynamics {
                joint,
                law: self.settled.friction[joint],
                coulomb: self.of(Number::Coulomb { joint }),
                viscous: self.of(Number::Viscous { joint }),
                armature: self.of(Number::Armature { joint }),
                offset: self.of(Number::Offset { joint }),
            }
        };
        self.problem.channels.iter().map(of).collect()
    }

    fn bodies(&self, is_held: &[bool]) -> Vec<BodyDynamics> {
        let masses = self.problem.arm.bodies.masses().iter().enumerate();
        let of = |(body, own): (usize, &haptical_model::RowMass)| {
            let entry = |entry| self.of(Number::Body { body, entry });
            let numbers: [Estimated; PARAMETERS] = std::array::from_fn(entry);
            BodyDynamics {
                row: own.row,
                inertia: match is_held[body] {
                    true => own.inertia,
                    false => {
                        haptical_dynamics::Inertia::from_parameters(numbers.map(|own| own.value))
                    }
                },
                nominal: own.inertia,
                sd: numbers.map(|own| own.sd),
                is_assumed: !own.has_mass,
                is_held: is_held[body],
            }
        };
        masses.map(of).collect()
    }

    fn base(
        &self,
        device: &Device,
        (base, estimate): (&Combinations, &Estimate),
        bias: Option<&[f64]>,
    ) -> Vec<BaseParameter> {
        let types: Vec<JointType> = device.joints.iter().map(|own| own.joint_type).collect();
        let nominal: Vec<f64> = (self.numbers.iter())
            .map(|own| own.nominal(self.problem))
            .collect();
        let nominal = &base.map * DVector::from_vec(nominal);
        let known: Vec<Option<f64>> = self.numbers.iter().map(|own| self.known_sd(*own)).collect();
        let of = |(row, kept): (usize, &usize)| {
            let kept = *kept;
            let others =
                (0..self.numbers.len()).filter(|k| *k != kept && base.map[(row, *k)] != 0.0);
            let terms: Vec<usize> = [kept].into_iter().chain(others).collect();
            let square = |k: &usize| Some((base.map[(row, *k)] * known[*k]?).powi(2));
            let square: Option<f64> = terms.iter().map(square).sum();
            BaseParameter {
                terms: (terms.iter())
                    .map(|k| (self.numbers[*k].name(self.problem), base.map[(row, *k)]))
                    .collect(),
                unit: self.numbers[kept].unit(&types),
                estimated: Estimated {
                    value: nominal[row] + estimate.values[row],
                    sd: estimate.sd[row],
                },
                nominal: nominal[row],
                known_sd: square.map(f64::sqrt),
                bias: bias.map(|own| own[row]),
            }
        };
        let all = base.kept().iter().enumerate();
        all.filter(|(_, kept)| self.numbers[**kept] != Number::Delay)
            .map(of)
            .collect()
    }

    /// Standard deviation of a body's number that is known beforehand, or of an armature's.
    fn known_sd(&self, number: Number) -> Option<f64> {
        match number {
            Number::Body { body, entry } => {
                let shape = self.shapes.iter().find(|own| own.0 == body);
                shape.map(|own| own.1.known_sd()[entry])
            }
            Number::Armature { joint } => {
                let stated = self.problem.arm.armature[joint].unwrap_or(0.0);
                Some(ARMATURE_SD * stated)
            }
            _ => None,
        }
    }

    fn delay(&self, base: &Combinations, estimate: &Estimate) -> Estimated {
        let place = |own: &usize| self.numbers[*own] == Number::Delay;
        let place = base.kept().iter().position(place);
        Estimated {
            // torques that are early are logged before their positions
            value: 0.0 - self.settled.early_s - place.map_or(0.0, |k| estimate.values[k]),
            sd: place.map_or(0.0, |k| estimate.sd[k]),
        }
    }
}
