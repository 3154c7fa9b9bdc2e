//! The torques of a moving arm, as `haptical-motion` examines them, in the words of a diagnosis.

pub(crate) mod between;
mod words;

use haptical_effects::device::is_law;
use haptical_effects::force::in_motion::SAMPLING;
use haptical_model::{Device, Recording};
use haptical_motion::{Finding, examine, is_moving_arm, link_torques};

use self::words::Words;
use crate::answer::ChannelGap;
use crate::force::answer::ForceAnswer;
use crate::force::recorded::torque_nm_without_effects;
use crate::force::{OnSecond, names};

/// A torque whose slope over the nominal one is below this has the other sign.
const WRONG_SIGN: f64 = -0.3;
/// Outside this the unit is another one.
const WRONG_UNIT: std::ops::Range<f64> = 0.02..30.0;

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
    let examined = examine(device, &bare(recording), second_bare.as_ref(), without).ok()?;
    let words = Words::of_torques(device, &examined);
    let seen = second.is_some().then(|| words.on_second());
    let answer = answer(&words);
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

fn answer(words: &Words<'_>) -> ForceAnswer {
    let (examined, is_adequate) = (words.examined, words.is_adequate);
    let channels: Vec<ChannelGap> = words.gaps();
    let mut findings = Vec::new();
    let of_log = examined
        .findings
        .first()
        .filter(|own| own.effect == SAMPLING.name);
    if let Some(found) = of_log.filter(|_| !is_adequate) {
        // rows that are missing bend the rest
        findings.push(words.cause(found, 1.0));
    } else if is_adequate {
        findings = words.causes();
    }
    let unexplained = match (examined.has_gap(), is_adequate || of_log.is_some()) {
        (_, true) => examined.unexplained_share(),
        (true, false) => 1.0,
        (false, false) => 0.0,
    };
    ForceAnswer {
        course: words.course(&channels),
        channels,
        untestable: untestable(),
        unexplained_share: unexplained,
        significant: examined.has_gap() || !findings.is_empty(),
        findings,
        not_tested: None,
        closed_unseen_share: None,
        numbers: examined.numbers,
        tested: examined.tried,
        warnings: warnings(words),
    }
}

/// Effects of the torques that need what a motion without a hand's force does not have.
fn untestable() -> Vec<(&'static str, String)> {
    let of_motion = haptical_motion::effect_names();
    let others = names().filter(|name| !of_motion.contains(name) && *name != SAMPLING.name);
    let why = "the equations of motion stand in its place: friction is free, and nobody is taken to hold the arm";
    others.map(|name| (name, why.to_owned())).collect()
}

fn warnings(words: &Words<'_>) -> Vec<String> {
    let examined = words.examined;
    let mut warnings = Vec::new();
    if let Some(why) = &examined.second {
        warnings.push(format!(
            "the torques of the second recording were not predicted: {why}"
        ));
    }
    for (joint, inertia) in &examined.free_armatures {
        warnings.push(format!(
            "the device file has no armature of joint {}: it was fitted, {inertia:.4} kg m^2, and is no cause",
            joint + 1
        ));
    }
    if examined
        .findings
        .iter()
        .any(|own| own.effect == SAMPLING.name)
        && !examined.is_adequate()
    {
        warnings.push(
            "the torques were not judged beyond the rows that the log repeats or lacks: record again without such rows".to_owned(),
        );
    }
    let is_kept = |found: &Finding| {
        let has = |name: &str| found.numbers.iter().any(|own| own.0 == name);
        let is_whole = |spec: &haptical_effects::Spec| {
            spec.parameters.len() == found.numbers.len()
                && spec.parameters.iter().all(|own| has(own.name))
        };
        let mut specs = haptical_effects::specs().filter(|spec| spec.name == found.effect);
        specs.any(|spec| spec.hook.is_on_drives() && is_law(spec).is_ok() && is_whole(spec))
    };
    let adequate = examined.findings.iter().filter(|_| examined.is_adequate());
    for found in adequate.filter(|own| !is_kept(own)) {
        warnings.push(format!(
            "corrected.toml does not hold {}: a device file has no such effect; put its numbers into the masses or the log by hand",
            found.effect
        ));
    }
    for own in examined.channels.iter().filter(|own| own.has_gap()) {
        let Some(slope) = own.slope else {
            continue;
        };
        let column = format!(
            "{}_{}",
            words.channel(own.joint),
            if words.unit(own.joint) == "N" {
                "n"
            } else {
                "nm"
            }
        );
        if slope < WRONG_SIGN {
            warnings.push(format!(
                "{column} moves against the torque that the links ask for (slope {slope:.2}): is its sign, or that of the joint, the other way?"
            ));
        } else if !WRONG_UNIT.contains(&slope.abs()) {
            warnings.push(format!(
                "{column} is {slope:.3} times what the links ask for: is it in N m at the joint, and not in N mm, at the motor, or a current?"
            ));
        }
    }
    for own in examined
        .channels
        .iter()
        .filter(|own| examined.is_adequate() && own.has_rest())
    {
        warnings.push(format!(
            "{} keeps {:.1} times its noise: no effect of the catalogue explains that rest",
            words.channel(own.joint),
            own.rms_after / own.noise
        ));
    }
    if examined.has_memory {
        warnings.push(
            "the noise of the torques has a memory: by its fastest part it is larger within the band than a white one".to_owned(),
        );
    }
    if examined.jitter > 0.1 {
        warnings.push(format!(
            "time stamps are {:.0} % of a step off an even grid (rms): readings were put on one",
            100.0 * examined.jitter
        ));
    }
    warnings
}
