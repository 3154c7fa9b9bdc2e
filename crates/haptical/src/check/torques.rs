//! What a log of joints and torques alone is good for: a diagnosis of the drives, and no identification.

use haptical_calibration::channels;
use haptical_model::{Device as Model, Recording};

use super::{CheckedChannel, CheckedLog, rate_hz, run_count};
use crate::identify::RankEntry;

/// The log described, where torques are all that it measures of a device with links.
pub(super) fn torques_alone(
    device: &Model,
    recording: &Recording,
    file: &str,
) -> Option<CheckedLog> {
    let readings = |joint: usize| {
        let column = recording.torque_nm.get(joint).and_then(Option::as_ref);
        column.map_or(0, |column| {
            column.iter().filter(|value| value.is_finite()).count()
        })
    };
    let read: Vec<usize> = (0..device.joints.len())
        .filter(|&joint| readings(joint) > 0)
        .collect();
    if read.is_empty() || !device.has_links() || channels(device, recording).is_ok() {
        return None;
    }
    let covariates = recording.covariates.iter().map(|(name, _)| name.clone());
    Some(CheckedLog {
        file: file.to_owned(),
        rows: recording.len(),
        runs: run_count(recording),
        rate_hz: rate_hz(recording),
        channels: read
            .iter()
            .map(|&joint| CheckedChannel {
                channel: format!("torque{}", joint + 1),
                unit: device.joints[joint].torque_unit(),
                readings: readings(joint),
            })
            .collect(),
        covariates: covariates.collect(),
        identifiability: RankEntry::default(),
        identifiable: Vec::new(),
        not_identified: Vec::new(),
        good_for: good_for(device, recording, read.len()),
    })
}

/// What `haptical diagnose` can and cannot ask of it, a sentence each.
fn good_for(device: &Model, recording: &Recording, torques: usize) -> Vec<String> {
    let mut said = vec![
        "Joints and torques alone: no number of the geometry can be identified from them, and what the torques are compared \
         with rests on the geometry of the device file."
            .to_owned(),
    ];
    let lacks = match (&recording.time_s, device.gravity_mps2) {
        (None, _) => Some("no column t_s in the log"),
        (_, None) => Some("no [gravity] in the device file"),
        _ => None,
    };
    if let Some(lacks) = lacks {
        said.push(format!(
            "haptical diagnose cannot test the torques: {lacks}."
        ));
        return said;
    }
    said.push(
        "haptical diagnose fits the inertial numbers of all links and tests what they leave: joint-friction, motor-cogging, \
         torque-gain."
            .to_owned(),
    );
    let runs = run_count(recording);
    said.push(match (runs, torques) {
        (1, _) => {
            "payload: not in one run, where a mass at the flange is one with the last link's; a second run (column run) with \
             another payload shows it."
                .to_owned()
        }
        (_, 1) => "payload: not from one torque alone, it shows on several joints.".to_owned(),
        _ => format!("payload: what the arm carries is compared over {runs} runs."),
    });
    if device.bodies.iter().all(Option::is_none) {
        said.push(
            "unbalanced-gravity: not without mass_kg and centre_of_mass_m in the device file."
                .to_owned(),
        );
    } else {
        said.push("unbalanced-gravity: the file's masses are taken as known to 10 %.".to_owned());
    }
    said
}
