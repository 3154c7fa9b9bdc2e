//! What a column is by its name, else by the number of columns.

use std::collections::BTreeMap;
use std::fmt;

use super::lists::{ANGLE, COMMAND, FOREIGN, POSITION, TORQUE, VELOCITY};
use super::{Joint, Proposal, groups, letters, limbs, named_lists};
use crate::mapping::{TEXTS, Unit, dimension_of};
use crate::table::{Cells, Table};

/// What a column is taken for.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Meaning {
    /// A column of the log by its own name.
    Log(String),
    /// Something of a joint, numbered as in the file; renumbered from 1 once all are known.
    Joint(OfJoint, usize),
    /// A part of the handle's position.
    Position(usize),
    /// A part of a quaternion, w first.
    Quaternion(usize),
    /// Roll, pitch or yaw.
    Angle(usize),
    /// A part of `rx`, `ry`, `rz`.
    Vector(usize),
    /// An element of a 3 x 3 or a 4 x 4 matrix, as it is listed.
    Matrix(usize),
    Pose(usize),
}

/// What is measured of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum OfJoint {
    Angle,
    Slide,
    Torque,
    Velocity,
    Command,
}

impl fmt::Display for Meaning {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let xyz = ["x", "y", "z"];
        match self {
            Self::Log(name) => write!(to, "{name}"),
            Self::Joint(OfJoint::Angle, joint) => write!(to, "theta{joint}_rad"),
            Self::Joint(OfJoint::Slide, joint) => write!(to, "theta{joint}_m"),
            Self::Joint(OfJoint::Torque, joint) => write!(to, "torque{joint}_nm"),
            Self::Joint(OfJoint::Velocity, joint) => write!(to, "velocity{joint}_rad_per_s"),
            Self::Joint(OfJoint::Command, joint) => write!(to, "command{joint}_rad"),
            Self::Position(part) => write!(to, "{}_m", xyz[*part]),
            Self::Quaternion(part) => write!(to, "{}", ["qw", "qx", "qy", "qz"][*part]),
            Self::Angle(part) => write!(to, "{}", ["roll", "pitch", "yaw"][*part]),
            Self::Vector(part) => write!(to, "r{}", xyz[*part]),
            Self::Matrix(element) | Self::Pose(element) => write!(to, "element {}", element + 1),
        }
    }
}

/// The words of a name in small letters, split at signs, between words in capitals and around digits; a unit at the end is left out.
pub(super) fn words(name: &str) -> Vec<String> {
    let bare = match name.find(['[', '(']) {
        // an element of a list keeps its number: `q[2]`
        Some(open)
            if name.ends_with(']')
                && name[open + 1..name.len() - 1]
                    .bytes()
                    .all(|byte| byte.is_ascii_digit()) =>
        {
            name.to_owned()
        }
        Some(open) if open > 0 => name[..open].to_owned(),
        _ => name.to_owned(),
    };
    let mut found: Vec<String> = Vec::new();
    let mut last = ' ';
    for letter in bare.chars() {
        let begins = !last.is_alphanumeric()
            || (letter.is_uppercase() && last.is_lowercase())
            || letter.is_ascii_digit() != last.is_ascii_digit();
        if letter.is_alphanumeric() {
            if begins || found.is_empty() {
                found.push(String::new());
            }
            if let Some(word) = found.last_mut() {
                word.extend(letter.to_lowercase());
            }
        }
        last = letter;
    }
    let is_unit = found
        .last()
        .is_some_and(|word| word.len() > 1 && Unit::parse(word).is_some());
    if found.len() > 1 && is_unit {
        found.pop();
    }
    found
}

/// The unit at the end of a name, after a sign: `q1_deg`, `q_deg[1]`.
pub(super) fn unit_at_end(name: &str) -> Option<&str> {
    let name = match name.rsplit_once('[') {
        Some((list, number)) if number.ends_with(']') => list,
        _ => name,
    };
    let (_, last) = name.rsplit_once(['_', ' ', '.', '/'])?;
    (last.len() > 1 && Unit::parse(last).is_some()).then_some(last)
}

/// Whether a name is one of time.
pub(super) fn is_time(name: &str) -> bool {
    // of a stamp the whole: its seconds or its nanoseconds alone are none
    let field = words(name.rsplit(['.', '/']).next().unwrap_or_default());
    let is_word = |word: &String| {
        matches!(
            word.as_str(),
            "t" | "time" | "timestamp" | "stamp" | "zeit" | "temps"
        )
    };
    let is_field = field.len() == 1 && field.iter().all(is_word);
    name == "t_s" || is_field || name.to_lowercase().contains("timestamp")
}

/// The meaning of each column of a file, with the reason; without one the reason why not.
pub(super) fn of(table: &Table, files: usize, joints: &[Joint]) -> Vec<(Option<Meaning>, String)> {
    let digits = digits(table);
    let has_names = || digits.len() < table.columns.len();
    if !table.is_named || !has_names() {
        return by_number(table, files, joints);
    }
    let all: Vec<&str> = table
        .columns
        .iter()
        .map(|column| column.name.as_str())
        .collect();
    let named = named_lists::of(table, joints);
    let lists = groups::of(table);
    let limbs = limbs::of(table, joints);
    let columns = table.columns.iter().enumerate();
    let mut found: Vec<(Option<Meaning>, String)> = columns
        .map(|(place, column)| {
            if let Some(own) = named.get(&place) {
                return own.clone();
            }
            if let Some(joint) = of_device(&column.name, joints) {
                let (name, slides) = &joints[joint];
                let kind = kind_of(&words(&column.name)).unwrap_or(OfJoint::Angle);
                let kind = if *slides && kind == OfJoint::Angle {
                    OfJoint::Slide
                } else {
                    kind
                };
                return (
                    Some(Meaning::Joint(kind, joint + 1)),
                    format!("the device's joint {} is `{name}`", joint + 1),
                );
            }
            let as_part = || lists.get(&place).or_else(|| limbs.get(&place));
            if let Some((meaning, why)) = as_part().or_else(|| digits.get(&place)) {
                return (Some(meaning.clone()), why.clone());
            }
            match by_name(&column.name, &all) {
                Some(meaning) => {
                    let is_text = matches!(column.cells, Cells::Texts(_));
                    let may_be =
                        matches!(&meaning, Meaning::Log(name) if TEXTS.contains(&name.as_str()));
                    match is_text && !may_be {
                        true => (None, "its cells are no numbers".to_owned()),
                        false => (Some(meaning), format!("by its name `{}`", column.name)),
                    }
                }
                None => (None, "its name says nothing that is known".to_owned()),
            }
        })
        .collect();
    let meanings: Vec<Option<Meaning>> = found.iter().map(|(own, _)| own.clone()).collect();
    for (place, own) in letters::of(table, &meanings) {
        found[place] = own;
    }
    found
}

/// Joints whose names are their numbers alone, `0` to `5` or `1` to `6` in order, by their place in the file.
fn digits(table: &Table) -> BTreeMap<usize, (Meaning, String)> {
    let columns = table.columns.iter().enumerate();
    let numbers = columns.filter_map(|(place, column)| Some((place, column.name.parse().ok()?)));
    let numbers: Vec<(usize, usize)> = numbers.collect();
    let first = numbers.first().map_or(0, |(_, number)| *number);
    let in_order = numbers.iter().zip(first..);
    let is_list = in_order.clone().all(|((_, number), own)| *number == own);
    if first > 1 || numbers.len() < 2 || numbers.len() > 64 || !is_list {
        return BTreeMap::new();
    }
    let joints = numbers.into_iter();
    joints
        .map(|(place, number)| {
            let why = "UNSURE: names of digits in order are taken for the joints".to_owned();
            (place, (Meaning::Joint(OfJoint::Angle, number), why))
        })
        .collect()
}

/// The device's joint that a name begins or ends with; the longest such name, else the only one that begins with the name.
pub(super) fn of_device(name: &str, joints: &[Joint]) -> Option<usize> {
    let simple = |text: &str| words(text).join("_");
    let own = simple(name);
    let foreign = |rest: &str| rest.split('_').any(|word| FOREIGN.contains(&word));
    let fits = |joint: &str| {
        let joint = simple(joint);
        let rest = own
            .strip_prefix(&joint)
            .or_else(|| own.strip_suffix(&joint));
        rest.filter(|rest| rest.is_empty() || rest.starts_with('_') || rest.ends_with('_'))
            .filter(|rest| !foreign(rest))
            .map(|_| joint.len())
    };
    let fitting = joints.iter().enumerate();
    let fitting = fitting.filter_map(|(place, (joint, _))| Some((fits(joint)?, place)));
    fitting
        .max_by_key(|(length, _)| *length)
        .map(|(_, place)| place)
        .or_else(|| begun_by(name, joints))
}

/// The only joint of the device whose name begins with the words of a name, `base_yaw` for `Base`, kinds of readings left out.
fn begun_by(name: &str, joints: &[Joint]) -> Option<usize> {
    let kinds = [&TORQUE[..], &VELOCITY, &COMMAND, &ANGLE].concat();
    let is_kind = |word: &String| kinds.contains(&word.as_str());
    let mut own = words(name);
    while own.len() > 1 && own.last().is_some_and(is_kind) {
        own.pop();
    }
    // a letter or a word of a place may begin any name
    let says_enough = own
        .first()
        .is_some_and(|word| word.len() > 2 && !is_kind(word) && !POSITION.contains(&word.as_str()));
    let begins = |joint: &Joint| words(&joint.0).starts_with(&own);
    let mut fitting = joints.iter().enumerate().filter(|(_, joint)| begins(joint));
    match (fitting.next(), fitting.next()) {
        (Some((place, _)), None) if says_enough => Some(place),
        _ => None,
    }
}

pub(super) fn kind_of(words: &[String]) -> Option<OfJoint> {
    let has = |list: &[&str]| words.iter().any(|word| list.contains(&word.as_str()));
    let kinds = [
        (&TORQUE[..], OfJoint::Torque),
        (&VELOCITY[..], OfJoint::Velocity),
        (&COMMAND[..], OfJoint::Command),
    ];
    kinds
        .iter()
        .find(|(list, _)| has(list))
        .map(|(_, kind)| *kind)
}

fn by_name(name: &str, all: &[&str]) -> Option<Meaning> {
    let log = ["run", "temp_degc", "fx_n", "fy_n", "fz_n", "cable_m", "t_s"];
    if log.contains(&name) || TEXTS.contains(&name) {
        return Some(Meaning::Log(name.to_owned()));
    }
    if is_time(name) {
        return Some(Meaning::Log("t_s".to_owned()));
    }
    if let Some(meaning) = of_a_log(name) {
        return Some(meaning);
    }
    let words = words(name);
    let parts: Vec<&str> = words.iter().map(String::as_str).collect();
    let joined = parts.join("");
    if let Some((joint, kind)) = numbered(&parts, all, name) {
        return Some(Meaning::Joint(kind, joint));
    }
    if let Some(meaning) = element(&parts, all, name.ends_with(']')) {
        return Some(meaning);
    }
    match joined.as_str() {
        "run" | "trial" | "episode" | "session" => return Some(Meaning::Log("run".to_owned())),
        "temp" | "temperature" | "tempdegc" => return Some(Meaning::Log("temp_degc".to_owned())),
        "fx" | "fy" | "fz" => return Some(Meaning::Log(format!("{joined}_n"))),
        "roll" | "pitch" | "yaw" => {
            return ["roll", "pitch", "yaw"]
                .iter()
                .position(|own| *own == joined)
                .map(Meaning::Angle);
        }
        _ => {}
    }
    if let Some(meaning) = of_a_maker(&joined, all) {
        return Some(meaning);
    }
    let (last, front) = parts.split_last()?;
    let is_turn = front.iter().all(|word| {
        let turns = [
            "q",
            "quat",
            "quaternion",
            "orientation",
            "rot",
            "rotation",
            "pose",
        ];
        turns.contains(word) || POSITION.contains(word)
    });
    let letter = |word: &str, stem: &str| {
        let rest = word.strip_prefix(stem)?;
        ["w", "x", "y", "z"].iter().position(|own| *own == rest)
    };
    let says_turn = front
        .iter()
        .any(|word| word.starts_with('q') || word.starts_with("ori") || word.starts_with("rot"));
    // three letters without a real part are no quaternion
    let real_part: Vec<&str> = front.iter().copied().chain(["w"]).collect();
    let has_real_part = || {
        let mut alike = all.iter().filter(|own| own.len() == name.len());
        alike.any(|own| self::words(own) == real_part)
    };
    let is_part = || is_turn && says_turn && has_real_part();
    let part = letter(last, "q").or_else(|| letter(last, "").filter(|_| is_part()));
    if let (Some(part), true) = (part, is_turn) {
        return Some(Meaning::Quaternion(part));
    }
    let axis = |stem: &str| {
        ["x", "y", "z"]
            .iter()
            .position(|own| last.strip_prefix(stem) == Some(own))
    };
    if let Some(axis) = axis("r").filter(|_| front.is_empty() || front == ["tcp"]) {
        return Some(Meaning::Vector(axis));
    }
    let axis = axis("")
        .or_else(|| axis("p"))
        .or_else(|| axis("t"))
        .or_else(|| axis("pos"));
    if says_turn {
        return None;
    }
    // a name may have a capital within: `OptiTrack`
    let whole = front.concat();
    let is_place = POSITION.contains(&whole.as_str())
        || front
            .iter()
            .all(|word| POSITION.contains(word) || ["pose", "actual", "measured"].contains(word));
    axis.filter(|_| is_place).map(Meaning::Position)
}

/// The log's own names of lengths: `x_m`, `theta4_m`.
fn of_a_log(name: &str) -> Option<Meaning> {
    let stem = name.strip_suffix("_m")?;
    let axis = ["x", "y", "z"].iter().position(|axis| *axis == stem);
    let slide = || stem.strip_prefix("theta")?.parse().ok();
    axis.map(Meaning::Position)
        .or_else(|| Some(Meaning::Joint(OfJoint::Slide, slide()?)))
}

/// The angles of makers that name them by single letters, beside X, Y and Z: KUKA turns by A about z, then by B about the new y
/// and by C about the new x; Fanuc by W, P and R about the fixed x, y and z. Both are roll, pitch and yaw.
fn of_a_maker(name: &str, all: &[&str]) -> Option<Meaning> {
    let has = |names: [&str; 3]| {
        names
            .iter()
            .all(|name| all.iter().any(|own| words(own).join("") == *name))
    };
    [["c", "b", "a"], ["w", "p", "r"]]
        .into_iter()
        .filter(|letters| has(*letters) && has(["x", "y", "z"]))
        .find_map(|letters| letters.iter().position(|letter| *letter == name))
        .map(Meaning::Angle)
}

/// The number and the kind of a joint's column: `q1`, `joint_2_pos`, `tau[3]`, `CaliJointAngles[1]`.
fn numbered(parts: &[&str], all: &[&str], name: &str) -> Option<(usize, OfJoint)> {
    let numbers: Vec<usize> = parts.iter().filter_map(|word| word.parse().ok()).collect();
    let [number] = numbers[..] else {
        return None;
    };
    let stem: Vec<String> = parts
        .iter()
        .filter(|word| word.parse::<usize>().is_err())
        .map(|word| (*word).to_owned())
        .collect();
    if stem.is_empty() || number > 64 {
        return None;
    }
    // three elements of what may be a place are a place
    let elements = all
        .iter()
        .filter(|own| own.split('[').next() == name.split('[').next())
        .count();
    let is_list = name.ends_with(']');
    let is_place = stem
        .iter()
        .all(|word| POSITION.contains(&word.as_str()) || word == "cali" || word == "test");
    if is_list && elements == 3 && is_place {
        return None;
    }
    let kind = kind_of(&stem);
    let others = [&TORQUE[..], &VELOCITY, &COMMAND, &ANGLE].concat();
    let is_known = |words: &[String]| {
        !words.is_empty()
            && words.iter().all(|word| {
                others.contains(&word.as_str())
                    || matches!(word.as_str(), "test" | "cali" | "array")
            })
    };
    // of a field within others the last name says it: `data.robot.q_deg[1]`
    let last = words(name.rsplit(['.', '/']).next().unwrap_or_default());
    let last = last.into_iter().filter(|word| {
        word.parse::<usize>().is_err() && (word.len() == 1 || Unit::parse(word).is_none())
    });
    let known = is_known(&stem) || is_known(&last.collect::<Vec<_>>());
    known.then_some((number, kind.unwrap_or(OfJoint::Angle)))
}

/// An element of a list that is a place.
fn element(parts: &[&str], all: &[&str], is_list: bool) -> Option<Meaning> {
    let (last, front) = parts.split_last()?;
    let number = last.parse::<usize>().ok()?.checked_sub(1)?;
    let is_place = front.iter().any(|word| POSITION.contains(word));
    if front.iter().any(|word| FOREIGN.contains(word)) || !(is_list || is_place) {
        return None;
    }
    let elements = all.iter().filter(|own| {
        let words = words(own);
        words.len() == parts.len()
            && words[..front.len()]
                .iter()
                .map(String::as_str)
                .eq(front.iter().copied())
    });
    match elements.count() {
        3 if number < 3 => Some(Meaning::Position(number)),
        _ => None,
    }
}

/// Without names: by the number of columns.
fn by_number(table: &Table, files: usize, joints: &[Joint]) -> Vec<(Option<Meaning>, String)> {
    let width = table.columns.len();
    let known = joints.len();
    let n_joints = match (known, width) {
        (0, 3) if files > 1 => 0,
        (0, 6 | 7) => width,
        (0, 9 | 10) => width - 3,
        (0, 12) => 6,
        (0, 13 | 14) => width - 7,
        (0, _) => 0,
        (_, 3) if files > 1 => 0,
        (_, _) if width >= known => known,
        _ => 0,
    };
    let rest = width - n_joints;
    let place = |column: usize| {
        let slides = joints.get(column).is_some_and(|(_, slides)| *slides);
        let kind = if slides {
            OfJoint::Slide
        } else {
            OfJoint::Angle
        };
        match column.checked_sub(n_joints) {
            None => Some(Meaning::Joint(kind, column + 1)),
            Some(part) if part < 3 && rest >= 3 => Some(Meaning::Position(part)),
            Some(part @ 3..7) if rest == 7 => Some(Meaning::Quaternion(part - 3)),
            _ => None,
        }
    };
    (0..width)
        .map(|column| match place(column) {
            Some(meaning) => (
                Some(meaning),
                format!("UNSURE: the file has no names; of {width} columns this may be it"),
            ),
            None => (
                None,
                format!("the file has no names, and {width} columns say nothing"),
            ),
        })
        .collect()
}

/// Joints that are counted from 0 are counted from 1 in a log.
pub(super) fn renumber(found: &mut [Proposal]) {
    for kind in [
        OfJoint::Angle,
        OfJoint::Slide,
        OfJoint::Torque,
        OfJoint::Velocity,
        OfJoint::Command,
    ] {
        let from_zero = found
            .iter()
            .any(|own| own.meaning == Meaning::Joint(kind, 0));
        if !from_zero {
            continue;
        }
        for own in found.iter_mut() {
            if let Meaning::Joint(of, number) = &mut own.meaning
                && *of == kind
            {
                *number += 1;
                own.why.push_str(", joints are counted from 0 there");
            }
        }
    }
}

/// What is numbered as a joint that slides is a length.
pub(super) fn slides(found: &mut [Proposal], joints: &[Joint]) {
    for own in found {
        if let Meaning::Joint(kind @ OfJoint::Angle, number) = &mut own.meaning
            && joints
                .get(number.wrapping_sub(1))
                .is_some_and(|(_, slides)| *slides)
        {
            *kind = OfJoint::Slide;
        }
    }
}

/// Takes out what is not whole: two parts of a position, three of a quaternion. Returns them with the reason.
pub(super) fn incomplete(found: &mut Vec<Proposal>) -> Vec<(usize, usize, String)> {
    let group = |meaning: &Meaning| match meaning {
        Meaning::Position(_) => Some((0, 3)),
        Meaning::Quaternion(_) => Some((1, 4)),
        Meaning::Angle(_) => Some((2, 3)),
        Meaning::Vector(_) => Some((3, 3)),
        Meaning::Matrix(_) => Some((4, 9)),
        Meaning::Pose(_) => Some((5, 16)),
        Meaning::Log(_) | Meaning::Joint(..) => None,
    };
    let mut taken_turn = None;
    let mut dropped = Vec::new();
    let kept: Vec<Proposal> = found.clone();
    found.retain(|own| {
        let Some((kind, wanted)) = group(&own.meaning) else {
            return true;
        };
        let count = kept
            .iter()
            .filter(|other| group(&other.meaning).map(|(of, _)| of) == Some(kind))
            .count();
        // of several orientations the first is taken
        let is_turn = kind > 0;
        // a pose may have three rows
        let is_whole = count == wanted || (wanted == 16 && count == 12);
        let is_first = !is_turn || !is_whole || *taken_turn.get_or_insert(kind) == kind;
        let keep = is_whole && is_first;
        if !keep {
            let why = match is_whole {
                true => "another orientation is taken already".to_owned(),
                false => format!("it may be a part of {wanted}, of which {count} are there"),
            };
            dropped.push((own.file, own.column, why));
        }
        keep
    });
    dropped
}

/// Whether the log's name has a unit.
pub(super) fn has_unit(meaning: &Meaning) -> bool {
    dimension_of(&meaning.to_string()).is_some()
        || matches!(meaning, Meaning::Angle(_) | Meaning::Vector(_))
}
