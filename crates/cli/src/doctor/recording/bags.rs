//! A bag of ROS 2 as a log: joint states of one topic, and of another the commands.

use std::path::Path;

use haptical_data::{BagJoints, bag_joints};

use super::logs::Log;
use crate::failure::Failure;

/// Words of a topic's name that make it the commanding side; of two arms the leader.
const COMMANDS: [&str; 8] = [
    "command",
    "cmd",
    "leader",
    "desired",
    "target",
    "action",
    "goal",
    "reference",
];

pub(super) fn read(file: &Path) -> Result<Log, Failure> {
    let topics = bag_joints(file)?;
    let is_command = |topic: &BagJoints| {
        let name = topic.topic.to_ascii_lowercase();
        COMMANDS.iter().any(|word| name.contains(word))
    };
    let names: Vec<&str> = topics.iter().map(|topic| topic.topic.as_str()).collect();
    let listed = names.join(", ");
    let mut states = topics.iter().filter(|topic| !is_command(topic));
    let (Some(state), None) = (states.next(), states.next()) else {
        let what = match topics.is_empty() {
            true => "it has no sensor_msgs/msg/JointState".to_owned(),
            false => format!("which topic has the measured joints is not clear: {listed}"),
        };
        let next = "give bags with one topic of joint states, and one whose name says command, leader, target or action";
        return Err(Failure::in_file("no-log", what, file, next));
    };
    let mut warnings = Vec::new();
    let command = topics.iter().find(|topic| is_command(topic));
    let command = command.and_then(|command| held(state, command));
    if command.is_none() && topics.len() > 1 {
        warnings.push(format!(
            "no topic has commands of all joints of {}: {listed}",
            state.topic
        ));
    }
    let start = state.time_ns.first().copied().unwrap_or(0);
    Ok(Log {
        names: state.names.clone(),
        time_s: state
            .time_ns
            .iter()
            .map(|ns| (ns - start) as f64 * 1e-9)
            .collect(),
        position: state.position.clone(),
        command: command.unwrap_or_default(),
        run: None,
        warnings,
    })
}

/// The commands at the times of the states: the last one before, as the joint had it. None where a joint has none.
fn held(state: &BagJoints, command: &BagJoints) -> Option<Vec<Vec<f64>>> {
    let of = |name: &String| {
        let place = command.names.iter().position(|other| other == name)?;
        let column = &command.position[place];
        let at = |time: &i64| {
            let after = command.time_ns.partition_point(|stamp| stamp <= time);
            after.checked_sub(1).map_or(f64::NAN, |last| column[last])
        };
        Some(state.time_ns.iter().map(at).collect())
    };
    state.names.iter().map(of).collect()
}
