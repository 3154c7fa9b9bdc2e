//! Which link a chain ends at: the one that was asked for, or the end of the longest chain.

use std::collections::BTreeMap;

use crate::UrdfError;
use crate::robot::Robot;

/// A path from the root: joints, from 0, in order.
#[derive(Debug, Clone)]
pub(crate) struct Path {
    pub(crate) tip: usize,
    pub(crate) joints: Vec<usize>,
}

/// Most names in a warning or an error.
const MOST_NAMES: usize = 8;

/// The path to the tip, and what is odd about the choice.
pub(crate) fn choose(
    robot: &Robot,
    file: &str,
    tip: Option<&str>,
) -> Result<(Path, Option<String>), UrdfError> {
    let refuse = |message: String| UrdfError::Chain {
        file: file.to_owned(),
        message,
    };
    if let Some(name) = tip {
        let found = robot.links.iter().position(|link| link.name == name);
        let Some(link) = found else {
            let names = robot.links.iter().map(|link| link.name.as_str());
            let message = format!("there is no link `{name}`; the links are {}", listed(names));
            return Err(refuse(message));
        };
        let path = path_to(robot, link);
        if moving(robot, &path) == 0 {
            let message =
                format!("no joint between the root and `{name}` moves: name another --tip");
            return Err(refuse(message));
        }
        return Ok((path, None));
    }
    let leaves = (0..robot.links.len()).filter(|link| robot.links[*link].child_joints.is_empty());
    let hands = Hands::new(robot);
    let mut chains: Vec<(Length, Path)> = leaves
        .map(|leaf| path_to(robot, leaf))
        .map(|path| (Length::new(robot, &hands, &path), path))
        .collect();
    // stable: chains of one length stay in the order of the file
    chains.sort_by_key(|(length, _)| (std::cmp::Reverse(length.own), length.of_hand));
    let mut chains = chains.into_iter();
    let Some((length, first)) = chains
        .next()
        .filter(|(length, _)| length.own + length.of_hand > 0)
    else {
        return Err(refuse(
            "no joint moves: there is no chain to calibrate".to_owned(),
        ));
    };
    let equal = chains.filter(|(other, _)| *other == length);
    let others: Vec<&str> = equal
        .map(|(_, path)| robot.links[path.tip].name.as_str())
        .collect();
    let warning = (!others.is_empty()).then(|| {
        format!(
            "{file}: the chain ends at `{}`; chains of the same length end at {}: choose with --tip",
            robot.links[first.tip].name,
            listed(others.iter().copied())
        )
    });
    Ok((first, warning))
}

/// Moving joints of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Length {
    own: usize,
    /// Joints that follow one beside the path, or that one beside the path follows: those of a hand's
    /// fingers.
    of_hand: usize,
}

impl Length {
    fn new(robot: &Robot, hands: &Hands, path: &Path) -> Self {
        let mut on_path = vec![false; robot.joints.len()];
        path.joints.iter().for_each(|joint| on_path[*joint] = true);
        let of_hand = |joint: &&usize| {
            robot.joints[**joint].moves()
                && (hands.source[**joint].is_some_and(|source| !on_path[source])
                    || hands.followers[**joint]
                        .iter()
                        .any(|follower| !on_path[*follower]))
        };
        let of_hand = path.joints.iter().filter(of_hand).count();
        Self {
            own: moving(robot, path) - of_hand,
            of_hand,
        }
    }
}

/// Who follows whom.
struct Hands {
    source: Vec<Option<usize>>,
    followers: Vec<Vec<usize>>,
}

impl Hands {
    fn new(robot: &Robot) -> Self {
        let names: BTreeMap<&str, usize> = robot
            .joints
            .iter()
            .enumerate()
            .map(|(index, joint)| (joint.name.as_str(), index))
            .collect();
        let mut hands = Self {
            source: Vec::new(),
            followers: vec![Vec::new(); robot.joints.len()],
        };
        for (index, joint) in robot.joints.iter().enumerate() {
            let mimic = joint.mimic.as_ref();
            let source = mimic.and_then(|mimic| names.get(mimic.joint.as_str()).copied());
            hands.source.push(source);
            if let Some(source) = source {
                hands.followers[source].push(index);
            }
        }
        hands
    }
}

/// Names in quotes, the first few of them.
pub(crate) fn listed<'n>(names: impl Iterator<Item = &'n str>) -> String {
    let names: Vec<String> = names.map(|name| format!("`{name}`")).collect();
    joined(&names)
}

/// Words with commas between, the first few of them.
pub(crate) fn joined(words: &[String]) -> String {
    let shown = words[..words.len().min(MOST_NAMES)].join(", ");
    match words.len().checked_sub(MOST_NAMES) {
        Some(more @ 1..) => format!("{shown} and {more} more"),
        _ => shown,
    }
}

fn path_to(robot: &Robot, tip: usize) -> Path {
    let mut joints = Vec::new();
    let mut link = tip;
    while let Some(joint) = robot.links[link].parent_joint {
        joints.push(joint);
        link = robot.joints[joint].parent;
    }
    joints.reverse();
    Path { tip, joints }
}

fn moving(robot: &Robot, path: &Path) -> usize {
    let joints = path.joints.iter();
    joints.filter(|joint| robot.joints[**joint].moves()).count()
}
