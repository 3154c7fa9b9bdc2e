//! The chosen topics of a bag as columns of a log.

use super::topics::{JointTopic, PoseCells, Topics};
use super::{BagOptions, not_a_log};
use crate::column::{ORIENTATION, POSITION, Role};
use crate::error::DataError;
use crate::error::near_miss::list;
use crate::nearest::{nearest, usual_distance_ns};
use crate::read::LoadedLog;
use crate::read::table::{Cell, Table};
use crate::shape::LogShape;

/// The log of the topics that `options` choose.
pub(super) fn log_of(
    topics: &Topics,
    wanted: &[String],
    name: &str,
    options: &BagOptions,
    shape: &LogShape,
) -> Result<LoadedLog, DataError> {
    let (topic_name, joints) = joint_topic(topics, wanted, name, options)?;
    let mut warnings = Vec::new();
    let mut warn = |what: String| warnings.push(format!("{name}: {what}"));
    let is_stamped = joints.stamps_ns.iter().any(|&stamp| stamp != 0);
    let stamps_ns = if is_stamped {
        &joints.stamps_ns
    } else {
        warn(format!(
            "the messages of `{topic_name}` have no stamps; the time of recording is taken"
        ));
        &joints.recorded_ns
    };
    let rows = increasing(stamps_ns);
    if rows.len() < stamps_ns.len() {
        warn(format!(
            "{} messages of `{topic_name}` do not come after the one before; they are left out",
            stamps_ns.len() - rows.len()
        ));
    }
    if joints.others > 0 {
        let count = joints.others;
        warn(format!(
            "{count} messages of `{topic_name}` have none of the joints; they are left out"
        ));
    }
    let stamps_ns: Vec<i64> = rows.iter().map(|&row| stamps_ns[row]).collect();
    let matched = matched_poses(topics, &stamps_ns, name, options, &mut warn)?;
    let mut columns = vec![("t_s".to_owned(), seconds(&stamps_ns))];
    for joint in 0..wanted.len() {
        let readings = rows.iter().map(|&row| joints.position[joint][row]);
        columns.push((Role::Joint(joint).name(shape), readings.collect()));
    }
    for (joint, device) in shape.joints.iter().enumerate() {
        let efforts: Vec<f64> = rows.iter().map(|&row| joints.effort[joint][row]).collect();
        if efforts.iter().all(|effort| effort.is_nan()) {
            continue;
        }
        if device.prismatic {
            let joint = &device.name;
            warn(format!(
                "the efforts of joint `{joint}`, which slides, are left out"
            ));
            continue;
        }
        columns.push((Role::Torque(joint).name(shape), efforts));
    }
    if let Some(matched) = matched {
        for (part, header) in POSITION.iter().chain(&ORIENTATION).enumerate() {
            let cells = matched.iter().map(|cells| cells[part]);
            columns.push(((*header).to_owned(), cells.collect()));
        }
    }
    let names = columns.iter().map(|(header, _)| header.as_str());
    let mut table = Table::new(names, name, shape)?;
    for (index, (_, cells)) in columns.iter().enumerate() {
        for &cell in cells {
            table.push(index, Cell::Number(cell))?;
        }
    }
    let mut log = table.finish()?;
    log.warnings.splice(0..0, warnings);
    Ok(log)
}

/// The topic with the joints.
fn joint_topic<'t>(
    topics: &'t Topics,
    wanted: &[String],
    name: &str,
    options: &BagOptions,
) -> Result<(&'t str, &'t JointTopic), DataError> {
    let refuse = |what: String, advice: &str| Err(not_a_log(name, what, advice));
    let chosen: Vec<(&str, &JointTopic)> = topics
        .joints
        .iter()
        .filter(|(topic, _)| options.joint_topic.as_ref().is_none_or(|t| t == *topic))
        .map(|(topic, joints)| (topic.as_str(), joints))
        .collect();
    if let (Some(topic), []) = (&options.joint_topic, &chosen[..]) {
        let there: Vec<String> = topics.joints.keys().cloned().collect();
        let what = format!("no joint states have the topic `{topic}`");
        let advice = format!("topics with joint states: {}", list_or_none(&there));
        return refuse(what, &advice);
    }
    // a joint that a message leaves out is no gap of one reading: the row would have none
    let is_whole = |joints: &JointTopic| joints.partial.is_none() && !joints.stamps_ns.is_empty();
    let partial = chosen
        .iter()
        .find_map(|(topic, joints)| Some((topic, joints.partial.as_ref()?)));
    let filled: Vec<(&str, &JointTopic)> = chosen
        .iter()
        .copied()
        .filter(|(_, joints)| is_whole(joints))
        .collect();
    match filled[..] {
        [only] => Ok(only),
        [] => {
            if let Some((topic, (number, lacking))) = partial {
                return refuse(
                    format!("message {number} of `{topic}` has no {}", list(lacking)),
                    "name another topic, or record one that has all joints in each message",
                );
            }
            let seen: Vec<String> = topics.names.iter().cloned().collect();
            let what = format!("no joint state has the joints {}", list(wanted));
            let advice = format!(
                "the messages name {}; give these names in the device's order",
                list_or_none(&seen)
            );
            refuse(what, &advice)
        }
        _ => {
            let there: Vec<String> = filled
                .iter()
                .map(|(topic, _)| (*topic).to_owned())
                .collect();
            let what = format!("{} topics have these joints: {}", there.len(), list(&there));
            refuse(what, "say which one is the log")
        }
    }
}

/// The poses of the chosen topic; several without a choice are left out with a warning.
fn matched_poses(
    topics: &Topics,
    stamps_ns: &[i64],
    name: &str,
    options: &BagOptions,
    warn: &mut impl FnMut(String),
) -> Result<Option<Vec<PoseCells>>, DataError> {
    let there: Vec<String> = topics.poses.keys().cloned().collect();
    let topic = match (&options.pose_topic, &there[..]) {
        (Some(topic), _) => topic,
        (None, [only]) => only,
        (None, []) => return Ok(None),
        (None, several) => {
            warn(format!(
                "poses on {} are left out: it is not said which are the handle's",
                list(several)
            ));
            return Ok(None);
        }
    };
    let Some(poses) = topics.poses.get(topic) else {
        let what = format!("no poses have the topic `{topic}`");
        let advice = format!("topics with poses: {}", list_or_none(&there));
        return Err(not_a_log(name, what, &advice));
    };
    let others_ns: Vec<i64> = poses.iter().map(|&(stamp_ns, _)| stamp_ns).collect();
    let matched = nearest(stamps_ns, &others_ns, usual_distance_ns(stamps_ns) / 2);
    if matched.left_out > 0 {
        warn(format!(
            "{} of {} poses on `{topic}` are left out: another is nearer to the row, or no row is near",
            matched.left_out,
            poses.len()
        ));
    }
    if matched.farthest_ns > 0 {
        warn(format!(
            "poses on `{topic}` are up to {} s away from their rows; in motion that is an error",
            matched.farthest_ns as f64 / 1e9
        ));
    }
    let cells = matched.of_row.iter();
    let cells = cells.map(|other| other.map_or([f64::NAN; 7], |other| poses[other].1));
    Ok(Some(cells.collect()))
}

/// Rows whose stamp comes after all before.
fn increasing(stamps_ns: &[i64]) -> Vec<usize> {
    let mut latest = None;
    let rows = stamps_ns.iter().enumerate().filter(|&(_, &stamp)| {
        let is_later = latest.is_none_or(|latest| stamp > latest);
        if is_later {
            latest = Some(stamp);
        }
        is_later
    });
    rows.map(|(row, _)| row).collect()
}

/// Time from the first row on \[s\]; exact to the nanosecond up to 100 days.
fn seconds(stamps_ns: &[i64]) -> Vec<f64> {
    let first = stamps_ns.first().copied().unwrap_or(0);
    let since = |&stamp: &i64| stamp.abs_diff(first) as f64 / 1e9;
    stamps_ns.iter().map(since).collect()
}

fn list_or_none(names: &[String]) -> String {
    if names.is_empty() {
        "none".to_owned()
    } else {
        list(names)
    }
}
