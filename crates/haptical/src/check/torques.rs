//! What a log of joints and torques alone is good for: a diagnosis of the drives, and no identification.

use haptical_calibration::channels;
use haptical_model::{Device as Model, Missing, Recording};
use haptical_motion::{Survey, SurveyedTorque, survey, why_not};

use super::{CheckedChannel, CheckedLog, commands};

/// Below this speed inertia is small beside friction and weight \[rad/s\], \[m/s\].
const SLOW: f64 = 0.1;

/// The log described, where torques are all that it measures of a device with links.
pub(super) fn torques_alone(
    device: &Model,
    recording: &Recording,
    file: &str,
) -> Option<CheckedLog> {
    let readings = |joint: usize| {
        let columns = recording.torque_nm.get(joint).into_iter().flatten();
        columns.flatten().filter(|value| value.is_finite()).count()
    };
    let joints = 0..device.joints.len();
    let read: Vec<usize> = joints.filter(|&joint| readings(joint) > 0).collect();
    if read.is_empty() || !device.has_links() || channels(device, recording).is_ok() {
        return None;
    }
    let covariates = recording.covariates.iter().map(|(name, _)| name.clone());
    let channels = read.iter().map(|&joint| CheckedChannel {
        channel: format!("torque{}", joint + 1),
        unit: device.joints[joint].torque_unit(),
        readings: readings(joint),
    });
    let rows = CheckedLog::of_rows(file, recording);
    let mut good_for = good_for(device, recording, (rows.runs, read.len()));
    good_for.extend(commands::of_commands(device, recording));
    Some(CheckedLog {
        channels: channels.collect(),
        covariates: covariates.collect(),
        good_for,
        ..rows
    })
}

/// What `haptical diagnose` can and cannot ask of it, a sentence each.
fn good_for(device: &Model, recording: &Recording, (runs, torques): (usize, usize)) -> Vec<String> {
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
        let words = format!("haptical diagnose cannot test the torques: {lacks}.");
        said.push(words);
        return said;
    }
    if recording.force_n.is_none()
        && let Ok(found) = survey(device, recording)
    {
        said.extend(of_motion(device, &found));
        return said;
    }
    if let Some(why) = why_not(device, recording) {
        said.push(format!(
            "The equations of motion cannot be used: {why}. What follows is for a slow motion."
        ));
    }
    said.push(
        "haptical diagnose fits the inertial numbers of all links and tests what they leave: joint-friction, motor-cogging, \
         torque-gain."
            .to_owned(),
    );
    said.push(match (runs, torques) {
        (1, _) => {
            "payload: not in one run, where a mass at the flange is one with the last link's; a second run (column run) with \
             another payload shows it."
                .to_owned()
        }
        (_, 1) => "payload: not from one torque alone, it shows on several joints.".to_owned(),
        _ => format!("payload: what the arm carries is compared over {runs} runs."),
    });
    let weight = match device.bodies.iter().all(Option::is_none) {
        true => "unbalanced-gravity: not without mass_kg and centre_of_mass_m in the device file.",
        false => "unbalanced-gravity: the file's masses are taken as known to 10 %.",
    };
    said.push(weight.to_owned());
    said
}

/// Joints by their numbers.
pub(super) fn numbered(joints: &[usize]) -> String {
    let numbers: Vec<String> = joints.iter().map(|own| (own + 1).to_string()).collect();
    let s = if joints.len() == 1 { "" } else { "s" };
    format!("joint{s} {}", numbers.join(", "))
}

/// What the equations of motion have to work with.
fn of_motion(device: &Model, found: &Survey) -> Vec<String> {
    let of = |is: &dyn Fn(usize) -> bool| -> Vec<usize> {
        (0..found.joints.len()).filter(|joint| is(*joint)).collect()
    };
    let torque = |joint: usize| found.joints[joint].torque;
    let good = of(&|joint| torque(joint) == SurveyedTorque::Changes);
    if good.is_empty() {
        let words = "The equations of motion cannot be used: no torque column changes.";
        return vec![words.to_owned()];
    }
    let mut said = vec![format!(
        "A moving arm: the equations of motion can be used, with masses, centres and inertias of the device file, {:.1} rows a second and the \
         torques of {}. haptical diagnose tests payload, link-inertia, friction, gains, delays, springs, contacts and more.",
        found.rate_hz,
        numbered(&good)
    )];
    let left_out = Missing::bodies(device).unwrap_or_default();
    if !left_out.is_empty() {
        let words: Vec<String> = left_out.iter().map(ToString::to_string).collect();
        said.push(format!(
            "Left out, and plausible ones taken, are: {}.",
            words.join(", ")
        ));
    }
    let constant = of(&|joint| matches!(torque(joint), SurveyedTorque::Constant(_)));
    let absent = of(&|joint| torque(joint) == SurveyedTorque::Absent);
    let throughout = "has one value throughout: nothing was measured there";
    let lacking = "is not in the log: nothing is said of it";
    for (joints, what) in [(constant, throughout), (absent, lacking)] {
        if !joints.is_empty() {
            said.push(format!("The torque of {} {what}.", numbered(&joints)));
        }
    }
    let still = of(&|joint| !found.joints[joint].moves);
    if still.is_empty() {
        said.push("Every joint moves.".to_owned());
    } else {
        said.push(format!(
            "Still throughout, so that nothing can be said of friction, gain, armature, spring or play there: {}. Move every joint.",
            numbered(&still)
        ));
    }
    let slow = of(&|joint| found.joints[joint].moves && found.joints[joint].fastest < SLOW);
    if !slow.is_empty() {
        said.push(format!(
            "Slower than {SLOW} rad/s or m/s, so that inertia and delay hardly show there: {}.",
            numbered(&slow)
        ));
    }
    let unstated = of(&|joint| device.joints[joint].armature_kgm2.is_none());
    if !unstated.is_empty() {
        said.push(format!(
            "The device file has no armature_kgm2 of {}: it is fitted, and cannot be a cause.",
            numbered(&unstated)
        ));
    }
    if found.jitter > 0.1 {
        said.push(format!(
            "Time stamps are {:.0} % of a step off an even grid.",
            100.0 * found.jitter
        ));
    }
    if found.lost_share > 0.01 {
        said.push(format!(
            "{:.0} % of the rows are next to gaps and are not used.",
            100.0 * found.lost_share
        ));
    }
    said
}
