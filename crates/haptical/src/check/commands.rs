//! What a log of joints and their commands is good for: a diagnosis of how the joints follow, and no identification.

use haptical_calibration::channels;
use haptical_model::{Device as Model, Recording};
use haptical_servo::{JointLog, Untested, untested};

use super::torques::numbered;
use super::{CheckedChannel, CheckedLog};

/// The log described, where nothing is measured beside the joints and their commands.
pub(super) fn commands_alone(
    device: &Model,
    recording: &Recording,
    file: &str,
) -> Option<CheckedLog> {
    let good_for = of_commands(device, recording);
    if good_for.is_empty() || channels(device, recording).is_ok() {
        return None;
    }
    let joints = device.joints.iter().enumerate();
    let channels = joints.filter_map(|(joint, entry)| {
        let command = recording.command(joint)?;
        Some(CheckedChannel {
            channel: format!("command{}", joint + 1),
            unit: entry.unit(),
            readings: command.iter().filter(|value| value.is_finite()).count(),
        })
    });
    let is_command = |name: &str| {
        let number = name.strip_prefix("command");
        number.is_some_and(|rest| rest.starts_with(|letter: char| letter.is_ascii_digit()))
    };
    let covariates = recording.covariates.iter().map(|(name, _)| name);
    let said = "Joints and their commands: no number of the geometry can be identified from them.";
    Some(CheckedLog {
        channels: channels.collect(),
        covariates: covariates
            .filter(|name| !is_command(name))
            .cloned()
            .collect(),
        good_for: [vec![said.to_owned()], good_for].concat(),
        ..CheckedLog::of_rows(file, recording)
    })
}

/// What `haptical diagnose` can and cannot ask of commands, a sentence each; nothing of a log without commands.
pub(super) fn of_commands(device: &Model, recording: &Recording) -> Vec<String> {
    let joints = 0..device.joints.len();
    let whys = joints.map(|joint| {
        let log = JointLog {
            time_s: recording.time_s.as_deref(),
            run: recording.run.as_deref(),
            command: recording.command(joint),
            response: &recording.joint[joint],
            velocity: recording.velocity(joint),
            ..JointLog::default()
        };
        (joint, untested(&log))
    });
    let whys: Vec<(usize, Option<Untested>)> = whys.collect();
    let lacks_command = |why: &Option<Untested>| matches!(why, Some(Untested::NoCommand));
    if whys.iter().all(|(_, why)| lacks_command(why)) {
        return Vec::new();
    }
    let with = |wanted: &Option<String>| -> String {
        let is_so = |why: &Option<Untested>| why.as_ref().map(ToString::to_string) == *wanted;
        let entry = whys.iter().filter(|(_, why)| is_so(why));
        let entry: Vec<usize> = entry.map(|(joint, _)| *joint).collect();
        let s = if entry.len() == 1 { "s" } else { "" };
        format!("how {} follow{s} the command", numbered(&entry))
    };
    let mut said = Vec::new();
    if whys.iter().any(|(_, why)| why.is_none()) {
        said.push(format!(
            "haptical diagnose tests {}: command-latency, servo-stiffness, speed-saturation, joint-friction, joint-offset, servo-gain, \
             and what of it changes within the log.",
            with(&None)
        ));
    }
    let mut reasons: Vec<String> = Vec::new();
    for why in whys.iter().filter_map(|(_, why)| why.as_ref()) {
        let why = why.to_string();
        if !reasons.contains(&why) {
            reasons.push(why);
        }
    }
    for why in reasons {
        let how = with(&Some(why.clone()));
        said.push(format!("haptical diagnose cannot test {how}: {why}."));
    }
    said
}
