//! The torques of a moving arm, as `haptical-motion` examines them, in the words of a diagnosis.

mod admission;
pub(crate) mod between;
mod tracking;
mod warnings;
mod words;

use haptical_effects::force::in_motion::SAMPLING;
use haptical_effects::law;
use haptical_model::{Device, DeviceEffect, Recording};
use haptical_motion::{MotionError, examine, is_moving_arm, link_torques};

pub(crate) use self::warnings::leaves_of_second;
use self::warnings::{silent, warnings};
use self::words::{Words, followed};
use crate::answer::{CandidateAnswer, CauseAnswer, ChannelGap, OnSecond, Untestable};
use crate::force::answer::ForceAnswer;
use crate::force::names;

/// What the torques of a moving arm say, and what is left of a second recording's; none for a device or a recording of another kind.
pub(crate) fn of_moving_arm(
    device: &Device,
    recording: &Recording,
    second: Option<&Recording>,
    without: &[String],
) -> Option<ForceAnswer> {
    if !is_moving_arm(device, recording) {
        return None;
    }
    let examined = match examine(device, recording, second, without) {
        Ok(examined) => examined,
        // at rest, and of a device that cannot be evaluated, there are other ways of looking at torques
        Err(MotionError::Standstill | MotionError::Model(_)) => return None,
        Err(why) => {
            let unseen = "those of the log were not tested";
            return Some(ForceAnswer {
                not_tested: Some(why.to_string()),
                second: second.map(|_| OnSecond::not_predicted(unseen)),
                ..ForceAnswer::default()
            });
        }
    };
    let words = Words::of_torques(device, &examined);
    let answer = ForceAnswer {
        second: second.is_some().then(|| words.on_second()),
        ..answer(&words)
    };
    let logs = (recording, second);
    Some(tracking::beside(device, logs, &examined, without, answer))
}

/// Whether the drives of a moving arm carry what its links ask for: something sees the links behind the drives, and no hand that is
/// not in the log pushes them. An encoder on a link is no sign of a hand. A gauge at the handle is one, unless the torques are explained
/// without it.
pub(crate) fn carries_links_alone(
    recording: &Recording,
    are_torques_explained: impl FnOnce() -> bool,
) -> bool {
    let sees_handle = recording.position_m.is_some()
        || recording.orientation_wxyz.is_some()
        || recording.contact.is_some()
        || recording.cable_m.iter().any(Option::is_some);
    recording.output.iter().any(Option::is_some) || (sees_handle && are_torques_explained())
}

/// A moving arm's recording with the torques that its links ask for in the place of the drives': what is between motor and link carries
/// those, without friction and the motors' inertia ([`carries_links_alone`]).
pub(crate) fn with_link_torques(device: &Device, recording: &Recording) -> Option<Recording> {
    let loads = link_torques(device, recording).ok()?.into_iter();
    let columns = recording.torque_nm.iter().zip(loads);
    let torque_nm = columns.map(|(read, load)| read.as_ref().map(|_| load));
    Some(Recording {
        torque_nm: torque_nm.collect(),
        ..recording.clone()
    })
}

/// A moving arm's recording with the loads that a diagnosis takes for those of springs and plays between motor and link: what the bodies
/// of the device ask for along the motion, in the place of the drives' torques, which have friction and the motors' inertia in them.
/// A row that no piece without a gap reaches keeps its drive's torque. None for a device or a recording of another kind, and for a
/// device in which nothing may follow a load between motor and link.
pub fn with_carried_loads(device: &Device, recording: &Recording) -> Option<Recording> {
    let is_between =
        |effect: &DeviceEffect| law(&effect.name).is_none_or(|(hook, _)| !hook.is_on_drives());
    let yields = |joint: usize| device.compliance_rad_per_nm(joint) != 0.0;
    let follows_load =
        (0..device.joints.len()).any(yields) || device.effects.iter().any(is_between);
    let are_explained = || {
        let torques = of_moving_arm(device, recording, None, &[]);
        torques.is_some_and(|torques| torques.is_explained())
    };
    if !follows_load
        || !is_moving_arm(device, recording)
        || !carries_links_alone(recording, are_explained)
    {
        return None;
    }
    let mut loaded = with_link_torques(device, recording)?;
    let columns = loaded.torque_nm.iter_mut().zip(&recording.torque_nm);
    for (load, read) in columns.filter_map(|(load, read)| load.as_mut().zip(read.as_ref())) {
        let unknown = load.iter_mut().zip(read).filter(|(load, _)| load.is_nan());
        unknown.for_each(|(load, read)| *load = *read);
    }
    Some(loaded)
}

fn answer(words: &Words<'_>) -> ForceAnswer {
    let (examined, is_adequate) = (words.examined, words.is_adequate);
    let channels: Vec<ChannelGap> = words.gaps();
    let mut findings = Vec::new();
    let of_log = examined.findings.first().filter(|own| own.is_of_sampling());
    if let Some(found) = of_log.filter(|_| !is_adequate) {
        // rows that are missing bend the rest
        findings.push(words.cause(found, 1.0));
    } else if is_adequate {
        findings = words.causes();
    }
    // that a log repeats rows or lacks some is no cause of a gap that stays once it is set right
    let closes = |own: &CauseAnswer| {
        let held_out = own.held_out.as_ref();
        held_out.is_some_and(|own| own.reduction_ci95.is_some_and(|ci95| ci95[0] > 0.0))
    };
    findings.retain(|own| own.effect != SAMPLING.name || closes(own));
    let is_explained = is_adequate || !findings.is_empty();
    let unexplained = match (examined.has_gap(), is_explained) {
        (_, true) => examined.unexplained_share(),
        (true, false) => 1.0,
        (false, false) => 0.0,
    };
    ForceAnswer {
        course: words.course(&channels),
        depends_on: followed(words, &channels),
        channels,
        untestable: untestable(),
        unexplained_share: unexplained,
        significant: examined.has_gap() || !findings.is_empty(),
        findings,
        numbers: examined.numbers,
        tested: examined.tried,
        closed_unseen_share: (examined.closed_unseen_share()).filter(|_| examined.is_partial()),
        candidates: refused(words),
        admission: admission::admission(words),
        adjusted: words.adjusted(),
        own_model: words.own_model(),
        changes: match is_adequate {
            true => (examined.findings.iter())
                .filter_map(|own| own.change)
                .collect(),
            false => Vec::new(),
        },
        bodies: examined.bodies.clone(),
        warnings: [warnings(words.device, examined), words.not_predicted()].concat(),
        silent: silent(examined).map(|joint| words.channel(joint)).collect(),
        ..ForceAnswer::default()
    }
}

/// What was found and is no answer, with what speaks against it.
fn refused(words: &Words<'_>) -> Vec<CandidateAnswer> {
    if words.is_adequate {
        return Vec::new();
    }
    let why = words.examined.why_no_answer();
    let all = words.causes().into_iter();
    all.map(|own| CandidateAnswer::of_cause(&own, Some(why.clone())))
        .collect()
}

/// Effects of the torques that need what a motion without a hand's force does not have.
fn untestable() -> Vec<Untestable> {
    let of_motion = haptical_motion::effect_names();
    let others = names().filter(|name| !of_motion.contains(name) && *name != SAMPLING.name);
    let why = "the equations of motion stand in its place: friction is free, and nobody is taken to hold the arm";
    others.map(|name| Untestable::new(name, why)).collect()
}
