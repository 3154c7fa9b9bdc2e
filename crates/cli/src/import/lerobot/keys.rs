//! Which columns of a data set hold what: those of LeRobot by their names, those of others by the words in theirs.

/// Where LeRobot's recorder writes the joints.
pub(super) const LEROBOT_STATE: &str = "observation.state";
/// Words of a key whose list is of positions of joints, the surest first.
const OF_POSITIONS: [&str; 6] = [
    "joint_position",
    "joint_pos",
    "joint.pos",
    "qpos",
    "joints",
    "state",
];
/// Words of a key whose list is of something else.
const OF_OTHERS: [&str; 13] = [
    "vel",
    "effort",
    "torque",
    "force",
    "current",
    "image",
    "eef",
    "cartesian",
    "ee_",
    "pose",
    "wrench",
    "delta",
    "environment",
];

/// Keys of one data set.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Keys {
    pub(super) state: String,
    /// None where the data set has no commands of joints.
    pub(super) action: Option<String>,
}

/// The key of the joints' positions among those of a Parquet file.
pub(super) fn of_state(names: &[String]) -> Result<String, Vec<&str>> {
    if names.iter().any(|name| name == LEROBOT_STATE) {
        return Ok(LEROBOT_STATE.to_owned());
    }
    let observed = names.iter().map(String::as_str);
    let observed: Vec<&str> = observed.filter(|name| !is_action(name)).collect();
    best(&observed).map(str::to_owned).ok_or(observed)
}

/// The key of what the joints were commanded to.
pub(super) fn of_action(names: &[String]) -> Option<String> {
    if names.iter().any(|name| name == "action") {
        return Some("action".to_owned());
    }
    let actions = names.iter().map(String::as_str);
    let actions: Vec<&str> = actions.filter(|name| is_action(name)).collect();
    best(&actions).map(str::to_owned)
}

fn is_action(name: &str) -> bool {
    ["action", "command", "target", "leader"]
        .iter()
        .any(|word| name.to_ascii_lowercase().contains(word))
}

/// The only key with the surest word that any has.
fn best<'n>(names: &[&'n str]) -> Option<&'n str> {
    let lower = |name: &str| name.to_ascii_lowercase().replace(['/', ' '], ".");
    let of_joints = names.iter().filter(|name| {
        let name = lower(name);
        !OF_OTHERS.iter().any(|word| name.contains(word))
    });
    let of_joints: Vec<&'n str> = of_joints.copied().collect();
    let with = |word: &&str| {
        let mut own = of_joints.iter().filter(|name| lower(name).contains(*word));
        match (own.next(), own.next()) {
            (Some(one), None) => Some(Some(*one)),
            (Some(_), Some(_)) => Some(None),
            (None, _) => None,
        }
    };
    OF_POSITIONS.iter().find_map(with).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(names: &[&str]) -> Option<String> {
        let names: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
        of_state(&names).ok()
    }

    #[test]
    fn keys_of_other_data_sets_are_found_by_their_words() {
        let lerobot = [
            "action",
            "observation.state",
            "observation.joint_position",
            "timestamp",
        ];
        assert_eq!(state(&lerobot).as_deref(), Some("observation.state"));
        for (names, expected) in [
            (
                &["observations/qpos", "observations/qvel", "action"][..],
                "observations/qpos",
            ),
            (
                &[
                    "observation.joint_positions",
                    "observation.joint_velocities",
                ],
                "observation.joint_positions",
            ),
            (
                &[
                    "observation.states.joint.position",
                    "observation.states.end.position",
                    "observation.states.effector.position",
                ],
                "observation.states.joint.position",
            ),
            (
                &[
                    "observation.state.joints",
                    "observation.state.eef_pose",
                    "action.joints",
                ],
                "observation.state.joints",
            ),
            (
                &["robot_state", "action", "observation.environment_state"],
                "robot_state",
            ),
        ] {
            assert_eq!(state(names).as_deref(), Some(expected), "{names:?}");
        }
        // two arms of equal words are asked about
        assert_eq!(state(&["left/qpos", "right/qpos"]), None);
        assert_eq!(state(&["observation.image", "timestamp"]), None);
        let action = |names: &[&str]| {
            of_action(
                &names
                    .iter()
                    .map(|&name| name.to_owned())
                    .collect::<Vec<_>>(),
            )
        };
        assert_eq!(
            action(&["action.joint_pos", "action.eef", "qpos"]).as_deref(),
            Some("action.joint_pos")
        );
        assert_eq!(action(&["qpos", "action.eef_pose"]), None);
    }
}
