//! The torques of a moving arm, as `haptical-motion` examines them, in the words of a diagnosis.

mod warnings;

use haptical_calibration::Channel;
use haptical_effects::force::in_motion::SAMPLING;
use haptical_model::{Device, JointType, Recording};
use haptical_motion::{
    Dependence, Examined, Finding, MotionError, PARTS, Quantity, Unseen, examine, is_moving_arm,
    link_torques,
};

use self::warnings::warnings;
use crate::answer::floor::Floor;
use crate::answer::{CauseAnswer, ChannelGap, HeldOutAnswer, ParameterAnswer, Prediction};
use crate::force::answer::{Course, Followed, ForceAnswer};
use crate::force::recorded::torque_nm_without_effects;
use crate::force::{OnSecond, names};
use crate::noise::NoiseSource;
use crate::thresholds::torque::LISTED_PROBABILITY;
use haptical_metrics::gap_reduction_percent;

/// A rival within this of a finding is not told apart from it: ln 100.
const NOT_TOLD_APART: f64 = 4.605;

/// A quantity is told where functions of it explain this share of a gap, and that one of what the best does.
const TOLD: f64 = 0.2;
const OF_MOST: f64 = 0.6;

/// What the torques of a moving arm say, and what is left of a second recording's; none for a device or a recording of another kind.
pub(crate) fn of_moving_arm(
    device: &Device,
    recording: &Recording,
    second: Option<&Recording>,
    without: &[String],
) -> Option<(ForceAnswer, Option<OnSecond>)> {
    if !is_moving_arm(device, recording) {
        return None;
    }
    // what the device's own effects add is taken off, as it is from the torques of any log
    let bare = |recording: &Recording| {
        let torques = 0..recording.torque_nm.len();
        Recording {
            torque_nm: torques
                .map(|joint| torque_nm_without_effects(device, recording, joint))
                .collect(),
            ..recording.clone()
        }
    };
    let second_bare = second.map(bare);
    let examined = match examine(device, &bare(recording), second_bare.as_ref(), without) {
        Ok(examined) => examined,
        // at rest, and of a device that cannot be evaluated, there are other ways of looking at torques
        Err(MotionError::Standstill | MotionError::Model(_)) => return None,
        Err(why) => {
            let answer = ForceAnswer {
                not_tested: Some(why.to_string()),
                ..ForceAnswer::default()
            };
            return Some((answer, None));
        }
    };
    let answer = answer(device, &examined);
    let seen = second.is_some().then(|| on_second(device, &examined));
    Some((answer, seen))
}

/// A moving arm's recording with the torques that its links ask for in the place of the drives': what is between motor and link carries
/// those, without friction and the motors' own inertia. None where no encoder is on the links.
pub(crate) fn with_link_torques(device: &Device, recording: &Recording) -> Option<Recording> {
    recording.output.iter().flatten().next()?;
    let torques = link_torques(device, recording).ok()?;
    let own = recording.torque_nm.iter().zip(torques);
    let torque_nm = own
        .map(|(own, torque)| own.as_ref().map(|_| torque))
        .collect();
    Some(Recording {
        torque_nm,
        ..recording.clone()
    })
}

/// Unit of a joint's torque.
fn unit(device: &Device, joint: usize) -> &'static str {
    match device.joints[joint].joint_type {
        JointType::Revolute => "N m",
        JointType::Prismatic => "N",
    }
}

fn channel(joint: usize) -> String {
    format!("torque{}", joint + 1)
}

fn answer(device: &Device, examined: &Examined) -> ForceAnswer {
    let is_adequate = examined.is_adequate();
    let gaps = examined.channels.iter().map(|own| {
        let floor = floor(own.joint, own.noise, own.before.len() as f64);
        let after = if is_adequate {
            own.rms_after
        } else {
            own.rms_before
        };
        let unit = unit(device, own.joint);
        let mut gap = ChannelGap::fitted(
            channel(own.joint),
            Some(own.joint),
            [own.rms_before, after],
            &floor,
            unit,
        );
        gap.has_gap = own.has_gap();
        gap
    });
    let channels: Vec<ChannelGap> = gaps.collect();
    let mut findings = Vec::new();
    let of_log = examined
        .findings
        .first()
        .filter(|own| own.effect == SAMPLING.name);
    if let Some(found) = of_log.filter(|_| !is_adequate) {
        // rows that are missing bend the rest
        findings.push(cause(device, examined, found, 1.0));
    } else if is_adequate {
        let total: f64 = examined.findings.iter().map(|own| own.nats.max(0.0)).sum();
        let explained = 1.0 - examined.unexplained_share();
        for found in &examined.findings {
            let share = explained * found.nats.max(0.0) / total.max(1e-300);
            findings.push(cause(device, examined, found, share));
        }
    }
    let unexplained = match (examined.has_gap(), is_adequate || of_log.is_some()) {
        (_, true) => examined.unexplained_share(),
        (true, false) => 1.0,
        (false, false) => 0.0,
    };
    ForceAnswer {
        course: course(device, examined, &channels),
        depends_on: followed(device, examined, &channels),
        channels,
        untestable: untestable(examined),
        unexplained_share: unexplained,
        significant: examined.has_gap() || !findings.is_empty(),
        findings,
        not_tested: None,
        closed_unseen_share: None,
        numbers: examined.numbers,
        tested: examined.tried,
        changes: match is_adequate {
            true => examined
                .findings
                .iter()
                .filter_map(|own| own.change)
                .collect(),
            false => Vec::new(),
        },
        warnings: warnings(device, examined),
    }
}

/// Effects of the torques that need what a motion without a hand's force does not have.
fn untestable(_: &Examined) -> Vec<(&'static str, String)> {
    let of_motion = haptical_motion::effect_names();
    let others = names().filter(|name| !of_motion.contains(name) && *name != SAMPLING.name);
    let why = "the equations of motion stand in its place: friction is free, and nobody is taken to hold the arm";
    others.map(|name| (name, why.to_owned())).collect()
}

fn floor(joint: usize, noise: f64, rows: f64) -> Floor {
    Floor {
        channel: Channel::Output { joint },
        rms: noise,
        freedom: rows.max(1.0),
        source: NoiseSource::Motion,
        is_another: false,
        is_contradicted: false,
    }
}

/// A finding as a cause.
fn cause(device: &Device, examined: &Examined, found: &Finding, share: f64) -> CauseAnswer {
    let near = found
        .rivals
        .iter()
        .filter(|own| own.behind_nats < NOT_TOLD_APART);
    let of_rivals: f64 = (found.rivals.iter())
        .map(|own| (-own.behind_nats.max(-5.0)).exp())
        .sum();
    let name = |effect: &str, joint: Option<usize>| match joint {
        Some(joint) if Some(joint) != found.joint => format!("{effect} at joint {}", joint + 1),
        _ => effect.to_owned(),
    };
    let ratio = found
        .joint
        .map_or(1.0, |joint| device.joints[joint].transmission_ratio);
    let numbers = found.numbers.iter().map(|(name, value, sd)| {
        // periods of the motor's turn
        let value = if *name == "order" {
            value / ratio
        } else {
            *value
        };
        (
            number_name(device, found.joint, name),
            ParameterAnswer::normal(value, *sd),
        )
    });
    CauseAnswer {
        confusable_with: near.map(|own| name(own.effect, own.joint)).collect(),
        parameters: numbers
            .filter(|(_, own)| own.value.is_finite() && own.ci95.iter().all(|end| end.is_finite()))
            .collect(),
        share,
        class_probability: LISTED_PROBABILITY,
        held_out: held_out(device, examined, found.joint),
        ..CauseAnswer::named(
            found.effect,
            found.joint,
            LISTED_PROBABILITY / (1.0 + of_rivals),
        )
    }
}

/// Of a joint that slides numbers have other units.
fn number_name(device: &Device, joint: Option<usize>, name: &str) -> String {
    let slides = joint.is_some_and(|joint| device.joints[joint].joint_type == JointType::Prismatic);
    match slides {
        true => name
            .replace("nm_s_per_rad", "n_s_per_m")
            .replace("nm_per_rad", "n_per_m")
            .replace("rad_per_s", "m_per_s")
            .replace("_rad", "_m")
            .replace("_nm", "_n")
            .replace("_kgm2", "_kg"),
        false => name.to_owned(),
    }
}

/// The gap of the torque with the largest one, or a joint's own, on rows that were not fitted.
fn held_out(device: &Device, examined: &Examined, joint: Option<usize>) -> Option<HeldOutAnswer> {
    let beyond = |own: &Unseen| {
        let rows: usize = own.rows.iter().sum();
        own.before.iter().sum::<f64>() / (own.noise.powi(2) * rows.max(1) as f64)
    };
    let of_joint = examined.unseen.iter().find(|own| Some(own.joint) == joint);
    let largest = || {
        examined
            .unseen
            .iter()
            .max_by(|a, b| beyond(a).total_cmp(&beyond(b)))
    };
    of_joint.or_else(largest).map(|own| answer_of(device, own))
}

fn answer_of(device: &Device, unseen: &Unseen) -> HeldOutAnswer {
    let rms = |sums: &[f64; PARTS], without: Option<usize>| {
        let kept = (0..PARTS).filter(|part| Some(*part) != without);
        let (sum, rows) = kept.fold((0.0, 0), |(sum, rows), part| {
            (sum + sums[part], rows + unseen.rows[part])
        });
        (sum / rows.max(1) as f64).sqrt()
    };
    let reduction = |without| {
        gap_reduction_percent(
            rms(&unseen.before, without),
            rms(&unseen.after, without),
            unseen.noise,
        )
    };
    let percent = reduction(None);
    // jackknife over the parts (Efron and Stein 1981)
    let parts: Option<Vec<f64>> = (0..PARTS).map(|part| reduction(Some(part))).collect();
    let interval = percent.zip(parts).map(|(percent, parts)| {
        let mean = parts.iter().sum::<f64>() / PARTS as f64;
        let square: f64 = parts.iter().map(|own| (own - mean).powi(2)).sum();
        let half = 1.96 * (square * (PARTS - 1) as f64 / PARTS as f64).sqrt();
        [percent - half, (percent + half).min(100.0)]
    });
    HeldOutAnswer {
        channel: channel(unseen.joint),
        rms_before: rms(&unseen.before, None),
        rms_after: rms(&unseen.after, None),
        noise_floor: unseen.noise,
        unit: unit(device, unseen.joint).to_owned(),
        reduction_percent: percent,
        reduction_ci95: interval,
        no_reduction: None,
    }
}

fn on_second(device: &Device, examined: &Examined) -> OnSecond {
    let is_second = examined.second.is_none();
    let unseen = examined.unseen.iter().filter(|_| is_second);
    let mut found = OnSecond::default();
    for own in unseen {
        found.held_out.push(answer_of(device, own));
        let of_row = |(row, [measured, before, after]): &(usize, [f64; 3])| Prediction {
            row: *row,
            channel: channel(own.joint),
            measured: *measured,
            before: *before,
            after: *after,
        };
        found.predictions.extend(own.predictions.iter().map(of_row));
    }
    found
}

/// The channel with the largest gap.
fn largest(channels: &[ChannelGap]) -> Option<usize> {
    let share = |index: &usize| channels[*index].share_of_gap;
    (0..channels.len()).max_by(|a, b| share(a).total_cmp(&share(b)))
}

/// What the largest gap depends on, in the log's columns.
fn followed(device: &Device, examined: &Examined, channels: &[ChannelGap]) -> Vec<Followed> {
    let Some(own) = largest(channels).map(|index| &examined.channels[index]) else {
        return Vec::new();
    };
    let most = own.depends_on.first().map_or(0.0, |own| own.share);
    let is_told = |own: &&Dependence| own.share > TOLD.max(OF_MOST * most);
    let joint = &device.joints[own.joint];
    let number = own.joint + 1;
    let position = format!("theta{number}_{}", joint.unit());
    let told = own.depends_on.iter().filter(is_told);
    let followed = told.map(|found| {
        let (column, words) = match found.quantity {
            Quantity::Position if joint.unit() == "m" => {
                (position.clone(), format!("the travel of joint {number}"))
            }
            Quantity::Position => (position.clone(), format!("the angle of joint {number}")),
            Quantity::Velocity => (
                position.clone(),
                format!("the speed and direction of joint {number}"),
            ),
            Quantity::Acceleration => (
                position.clone(),
                format!("the acceleration of joint {number}"),
            ),
            Quantity::Load => (
                joint.torque_column(number),
                format!("the load of joint {number}"),
            ),
            Quantity::Time => ("t_s".to_owned(), "time".to_owned()),
        };
        Followed {
            column,
            words,
            share: found.share,
        }
    });
    let mut told: Vec<Followed> = Vec::new();
    for own in followed {
        // angle and speed are of one column
        if !told.iter().any(|other| other.column == own.column) {
            told.push(own);
        }
    }
    told
}

/// The torque with the largest gap over time.
fn course(device: &Device, examined: &Examined, channels: &[ChannelGap]) -> Option<Course> {
    let most = largest(channels)?;
    let own = &examined.channels[most];
    let after = if examined.is_adequate() {
        &own.after
    } else {
        &own.before
    };
    Some(Course {
        channel: channel(own.joint),
        unit: unit(device, own.joint),
        time_s: examined.time_s.clone(),
        before: own.before.clone(),
        after: after.clone(),
    })
}
