//! The links at the ends of a chain: those that were asked for, or the root and the end of the longest chain.

use std::collections::BTreeMap;

use crate::UrdfError;
use crate::chain::path::{BaseAndTip, Path};
use crate::robot::Robot;
use crate::words::listed;

/// The paths to the tips, and what is odd about the choice.
pub(crate) fn choose(
    robot: &Robot,
    file: &str,
    ends: BaseAndTip<'_>,
) -> Result<(Vec<Path>, Option<String>), UrdfError> {
    let (first, warning) = choose_first(robot, file, ends)?;
    let base = ends.base.map(|_| first.base);
    let mut paths = vec![first];
    for name in ends.further_tips {
        let tip = link(robot, file, name)?;
        if paths.iter().any(|path| path.tip == tip) {
            let message = format!("the tip `{name}` is named twice: name each hand once");
            let file = file.to_owned();
            return Err(UrdfError::Chain { file, message });
        }
        paths.push(named(robot, file, base, tip)?);
    }
    if let Some(apart) = paths.iter().find(|path| path.base != paths[0].base) {
        let [own, other] = [&paths[0], apart].map(|path| &robot.links[path.tip].name);
        let message = format!("`{own}` and `{other}` are in separate trees: name the tips of one");
        let file = file.to_owned();
        return Err(UrdfError::Chain { file, message });
    }
    Ok((paths, warning))
}

fn choose_first(
    robot: &Robot,
    file: &str,
    ends: BaseAndTip<'_>,
) -> Result<(Path, Option<String>), UrdfError> {
    let base = ends.base.map(|name| link(robot, file, name)).transpose()?;
    let tip = ends.tip.map(|name| link(robot, file, name)).transpose()?;
    match (base, tip) {
        (base, Some(tip)) => Ok((named(robot, file, base, tip)?, None)),
        (Some(base), None) => Err(tip_missing(robot, file, base)),
        (None, None) => longest(robot, file),
    }
}

/// A link by its name.
pub(crate) fn link(robot: &Robot, file: &str, name: &str) -> Result<usize, UrdfError> {
    let found = robot.links.iter().position(|link| link.name == name);
    found.ok_or_else(|| UrdfError::UnknownLink {
        file: file.to_owned(),
        link: name.to_owned(),
        links: listed(robot.links.iter().map(|link| link.name.as_str())),
    })
}

/// The path between links that were named; from the root where no base was.
fn named(robot: &Robot, file: &str, base: Option<usize>, tip: usize) -> Result<Path, UrdfError> {
    let name = |link: usize| robot.links[link].name.clone();
    let path = match base {
        None => Path::from_root(robot, tip),
        Some(base) if base == tip => {
            return Err(UrdfError::SameLink {
                file: file.to_owned(),
                link: name(tip),
            });
        }
        Some(base) => Path::between(robot, base, tip).ok_or_else(|| UrdfError::Chain {
            file: file.to_owned(),
            message: format!(
                "no joints lead from `{}` to `{}`: they are in separate trees",
                name(base),
                name(tip)
            ),
        })?,
    };
    if path.moving(robot) == 0 {
        return Err(UrdfError::Unmoved {
            file: file.to_owned(),
            base: base.map(name),
            tip: name(tip),
        });
    }
    Ok(path)
}

fn tip_missing(robot: &Robot, file: &str, base: usize) -> UrdfError {
    let (file, ends) = (file.to_owned(), branch_ends(robot, base));
    let base = robot.links[base].name.clone();
    if ends.is_empty() {
        let message = format!("no joint moves between `{base}` and any other link");
        return UrdfError::Chain { file, message };
    }
    UrdfError::TipMissing {
        file,
        base,
        ends: listed(ends.into_iter()),
    }
}

/// Links on one joint alone, with joints that move between them and a base.
fn branch_ends(robot: &Robot, base: usize) -> Vec<&str> {
    let ends = robot.links.iter().enumerate().filter(|(index, link)| {
        let joints = link.child_joints.len() + usize::from(link.parent_joint.is_some());
        let path = (joints == 1).then(|| Path::between(robot, base, *index));
        path.flatten().is_some_and(|path| path.moving(robot) > 0)
    });
    ends.map(|(_, link)| link.name.as_str()).collect()
}

fn longest(robot: &Robot, file: &str) -> Result<(Path, Option<String>), UrdfError> {
    let leaves = (0..robot.links.len()).filter(|link| robot.links[*link].child_joints.is_empty());
    let hands = Hands::new(robot);
    let mut chains: Vec<(Length, Path)> = leaves
        .map(|leaf| Path::from_root(robot, leaf))
        .map(|path| (Length::new(robot, &hands, &path), path))
        .collect();
    // stable: chains of one length stay in the order of the file
    chains.sort_by_key(|(length, _)| (std::cmp::Reverse(length.own), length.of_hand));
    let mut chains = chains.into_iter();
    let Some((length, first)) = chains
        .next()
        .filter(|(length, _)| length.own + length.of_hand > 0)
    else {
        return Err(UrdfError::Chain {
            file: file.to_owned(),
            message: "no joint moves: there is no chain to calibrate".to_owned(),
        });
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
    /// Joints that follow one off the path, or that one off the path follows: those of a hand's
    /// fingers.
    of_hand: usize,
}

impl Length {
    fn new(robot: &Robot, hands: &Hands, path: &Path) -> Self {
        let on_path = path.passed(robot);
        let of_hand = |joint: &usize| {
            robot.joints[*joint].moves()
                && (hands.source[*joint].is_some_and(|source| !on_path[source])
                    || hands.followers[*joint]
                        .iter()
                        .any(|follower| !on_path[*follower]))
        };
        let joints = path.steps.iter().map(|step| step.joint);
        let of_hand = joints.filter(of_hand).count();
        Self {
            own: path.moving(robot) - of_hand,
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
