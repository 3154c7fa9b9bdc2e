//! Free functions of one covariate at one place: where a gap lies before any name is tried, and whether a
//! named law leaves something that its own covariate still explains.

use std::f64::consts::TAU;

use haptical_calibration::Channel;
use haptical_effects::{Context, Effect, Family, Hook, Signal};
use haptical_linalg::hat_functions;
use haptical_model::kinematics::nalgebra::Vector3;

use crate::engine::System;
use crate::select::{Candidate, Score};

/// A recorded or derived quantity that a residual may depend on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Covariate {
    Angle(usize),
    /// Place in the turn of the joint's motor-side drum \[rad\].
    MotorPhase(usize),
    /// Side that a joint came to a single posture from: 1 from below.
    Side(usize),
    Speed(usize),
    Torque(usize),
    Time,
    Temperature,
    /// Of a cable, from 0.
    Length(usize),
    CableSpeed,
    ExitAngle,
    Force,
}

impl Covariate {
    /// Its values at every row, where they were recorded and vary.
    pub(crate) fn values(self, context: &Context<'_>) -> Option<Vec<f64>> {
        let motion = context.motion.as_ref().filter(|_| context.ordered);
        match self {
            Self::Angle(joint) => context.recording.joint.get(joint).cloned(),
            Self::MotorPhase(joint) => {
                let ratio = context.device.joints[joint].transmission_ratio;
                let angle = context.recording.joint.get(joint)?;
                let turn = |angle: &f64| (ratio * angle).rem_euclid(TAU);
                (ratio.abs() > 1.0).then(|| angle.iter().map(turn).collect())
            }
            Self::Side(joint) => sides(context, joint),
            Self::Speed(joint) => Some(motion?.get(joint)?.velocity.clone()),
            Self::Torque(joint) => context.torque_nm.get(joint)?.clone(),
            Self::Time => context.elapsed_s(),
            Self::Temperature => context.warming_k.clone(),
            Self::Length(cable) => context.cable_length_m(cable),
            Self::CableSpeed => {
                motion?;
                Some(context.cable.as_ref()?.motion.velocity.clone())
            }
            Self::ExitAngle => {
                let cable = context.cable.as_ref()?;
                let angles = cable.direction.iter().map(|direction| {
                    let sine = direction.cross(&cable.exit_axis).norm();
                    sine.atan2(direction.dot(&cable.exit_axis))
                });
                Some(angles.collect())
            }
            Self::Force => {
                let force = context.force_n.as_ref()?;
                Some(force.iter().map(Vector3::norm).collect())
            }
        }
    }

    /// The log's column that carries it.
    pub(crate) fn column(self, context: &Context<'_>) -> String {
        let joints = &context.device.joints;
        match self {
            Self::Angle(joint)
            | Self::MotorPhase(joint)
            | Self::Side(joint)
            | Self::Speed(joint) => format!("theta{}_{}", joint + 1, joints[joint].unit()),
            Self::Torque(joint) => joints[joint].torque_column(joint + 1),
            Self::Time => "t_s".to_owned(),
            Self::Temperature => "temp_degc".to_owned(),
            Self::Length(cable) => format!("{}_m", Channel::Cable { index: cable }.name()),
            Self::CableSpeed | Self::ExitAngle => "cable_m".to_owned(),
            Self::Force => "fx_n".to_owned(),
        }
    }

    /// What of the column it is, in words.
    pub(crate) fn words(self, context: &Context<'_>) -> String {
        match self {
            Self::Angle(joint) if context.device.joints[joint].unit() == "m" => {
                format!("the travel of joint {}", joint + 1)
            }
            Self::Angle(joint) => format!("the angle of joint {}", joint + 1),
            Self::MotorPhase(joint) => format!("the turn of the motor of joint {}", joint + 1),
            Self::Side(joint) => format!("the side that joint {} came from", joint + 1),
            Self::Speed(joint) => format!("the speed of joint {}", joint + 1),
            Self::Torque(joint) => format!("the torque of joint {}", joint + 1),
            Self::Time => "time".to_owned(),
            Self::Temperature => "temperature".to_owned(),
            Self::Length(0) => "the cable's length".to_owned(),
            Self::Length(cable) => format!("the length of cable {}", cable + 1),
            Self::CableSpeed => "the cable's speed".to_owned(),
            Self::ExitAngle => "the angle at which the cable leaves its guide".to_owned(),
            Self::Force => "the size of the hand's force".to_owned(),
        }
    }
}

/// The sign of a joint's last step at every row, 0 before the first of a run.
pub(crate) fn sides(context: &Context<'_>, joint: usize) -> Option<Vec<f64>> {
    let reading = context.recording.joint.get(joint)?;
    let mut side = vec![0.0; reading.len()];
    for run in &context.runs {
        for row in run.clone().skip(1) {
            let step = reading[row] - reading[row - 1];
            side[row] = if step == 0.0 {
                side[row - 1]
            } else {
                step.signum()
            };
        }
    }
    Some(side)
}

/// Where a free function acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) hook: Hook,
    pub(crate) joint: Option<usize>,
}

impl Place {
    pub(crate) const fn at(hook: Hook, joint: Option<usize>) -> Self {
        Self { hook, joint }
    }
}

/// Hat functions of a covariate at a place: piecewise linear over `knots` equal intervals.
pub(crate) fn free_function(
    context: &Context<'_>,
    place: Place,
    covariate: Covariate,
    knots: usize,
) -> Option<Vec<Signal>> {
    let hats = hats(&covariate.values(context)?, knots)?;
    hats.iter().map(|hat| apply(context, place, hat)).collect()
}

/// The angle of another joint times hat functions of a joint's own: a coupling whose gain is not constant.
pub(crate) fn varying_gain(
    context: &Context<'_>,
    place: Place,
    from: usize,
    knots: usize,
) -> Option<Vec<Signal>> {
    let own = Covariate::Angle(place.joint?).values(context)?;
    let other = context.recording.joint.get(from)?;
    let hats = hats(&own, knots)?;
    let products = hats.iter().map(|hat| {
        let pairs = hat.iter().zip(other);
        pairs.map(|(hat, angle)| hat * angle).collect::<Vec<f64>>()
    });
    products
        .map(|product| apply(context, place, &product))
        .collect()
}

/// Hat functions over `knots` equal intervals of what all but a hundredth of the values lie in.
pub(crate) fn hats(values: &[f64], knots: usize) -> Option<Vec<Vec<f64>>> {
    let (low, high) = inner_range(values)?;
    Some(hat_functions(values, [low, high], knots))
}

/// The range that all but a hundredth of the values lie in.
pub(crate) fn inner_range(values: &[f64]) -> Option<(f64, f64)> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    if sorted.len() < 8 {
        return None;
    }
    sorted.sort_by(f64::total_cmp);
    let low = sorted[sorted.len() / 200];
    let high = sorted[sorted.len() - 1 - sorted.len() / 200];
    (high > low).then_some((low, high))
}

fn apply(context: &Context<'_>, place: Place, error: &[f64]) -> Option<Signal> {
    let signal = match (place.hook, place.joint) {
        (Hook::Transmission, Some(joint)) => context.upstream(joint, error),
        (Hook::ExternalEncoder, Some(joint)) => context.encoder(joint, error),
        (Hook::Joint, Some(joint)) => context.downstream(joint, error),
        (Hook::CableSensor, _) => context.cable_error(error.to_vec()),
        _ => return None,
    };
    (!signal.parts.is_empty()).then_some(signal)
}

/// What a free function explains on top of what is in the system.
pub(crate) fn score(
    system: &System,
    context: &Context<'_>,
    place: Place,
    covariate: Covariate,
    knots: usize,
) -> Option<Score> {
    let signals = free_function(context, place, covariate, knots)?;
    Some(Candidate::of_signals(system, &signals, usize::MAX, 0.0).score(system))
}

/// Covariates that an effect's law speaks of, and where: what a wrong law would leave there.
pub(crate) fn own_covariates(effect: &dyn Effect) -> Vec<(Place, Covariate, usize)> {
    let hook = match effect.spec().hook {
        Hook::Structure | Hook::Timing => Hook::CableSensor,
        hook => hook,
    };
    let place = Place::at(hook, effect.joint());
    let of_joint = |covariate: fn(usize) -> Covariate, knots: usize| {
        effect.joint().map(|joint| (place, covariate(joint), knots))
    };
    let cable = |covariate, knots| Some((place, covariate, knots));
    let wanted = match effect.spec().family {
        Family::Shape if effect.joint().is_some() => vec![of_joint(Covariate::Angle, 24)],
        Family::Shape | Family::Exit => {
            vec![
                cable(Covariate::Length(0), 16),
                cable(Covariate::ExitAngle, 12),
            ]
        }
        Family::Loop => vec![
            of_joint(Covariate::Angle, 16),
            of_joint(Covariate::Speed, 8),
        ],
        Family::Step | Family::Drift => vec![cable(Covariate::Time, 12)],
        Family::Lag => vec![
            of_joint(Covariate::Speed, 10),
            cable(Covariate::CableSpeed, 10),
        ],
        Family::Load => vec![
            of_joint(Covariate::Torque, 10),
            of_joint(Covariate::Angle, 12),
        ],
        Family::Coupling => vec![of_joint(Covariate::Angle, 12)],
        Family::Wobble | Family::Periodic | Family::Place | Family::Stated => vec![],
        Family::Tool => vec![cable(Covariate::Time, 8)],
    };
    wanted.into_iter().flatten().collect()
}
