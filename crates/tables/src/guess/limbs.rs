//! Joints that are called by the part of an arm that they turn: base, shoulder, elbow, wrist 1 to 3, as pendants show them.

use std::collections::BTreeMap;

use super::Joint;
use super::lists::{ANGLE, COMMAND, TORQUE, VELOCITY};
use super::names::{Meaning, OfJoint, kind_of, of_device, words};
use crate::table::Table;

/// Parts from the base to the flange; of one place in a line.
const LIMBS: [&[&str]; 5] = [
    &["base", "waist"],
    &["shoulder"],
    &["elbow"],
    &["forearm"],
    &["wrist"],
];
/// Words of the axis that a joint of a limb turns about, and of fields around it.
const BESIDE: [&str; 19] = [
    "pan", "lift", "flex", "roll", "pitch", "yaw", "rotate", "rotation", "angle", "up", "down",
    "field", "data", "robot", "arm", "left", "right", "l", "r",
];
/// The letters of Motoman's axes, in order.
const LETTERS: [&str; 6] = ["s", "l", "u", "r", "b", "t"];

/// A column that is called by a limb.
struct Limb {
    place: usize,
    kind: OfJoint,
    /// Order in the arm: the limb, its number, pan before lift.
    order: (usize, usize, usize),
}

/// What columns are as joints of limbs in the arm's order, by their place in the file.
pub(super) fn of(table: &Table, joints: &[Joint]) -> BTreeMap<usize, (Meaning, String)> {
    let numeric = |place: usize| table.columns[place].cells.numbers().is_some();
    let columns = table.columns.iter();
    let all: Vec<Vec<String>> = columns.map(|column| words(&column.name)).collect();
    if let Some(letters) = letters(&all).filter(|_| matches!(joints.len(), 0 | 6)) {
        let found = letters.into_iter().enumerate();
        let why = "S, L, U, R, B, T are the joints of Motoman".to_owned();
        return found
            .map(|(joint, place)| {
                (
                    place,
                    (Meaning::Joint(OfJoint::Angle, joint + 1), why.clone()),
                )
            })
            .collect();
    }
    let columns = all.iter().enumerate();
    let limbs = columns.filter(|(place, _)| numeric(*place));
    let limbs: Vec<Limb> = limbs
        .filter_map(|(place, words)| limb(place, words))
        .collect();
    let mut found = BTreeMap::new();
    for kind in [
        OfJoint::Angle,
        OfJoint::Torque,
        OfJoint::Velocity,
        OfJoint::Command,
    ] {
        let mut entry: Vec<&Limb> = limbs.iter().filter(|limb| limb.kind == kind).collect();
        entry.sort_by_key(|limb| (limb.order, limb.place));
        for (joint, limb) in entry.iter().enumerate() {
            found.insert(limb.place, (kind, joint + 1));
        }
        let name = |limb: &&&Limb| of_device(&table.columns[limb.place].name, joints);
        let named = entry.iter().enumerate();
        let contradicts = named
            .clone()
            .any(|(joint, limb)| name(&limb).is_some_and(|entry| entry != joint));
        // a limb's joint turns
        let lacks = !joints.is_empty()
            && (entry.len() != joints.len() || joints.iter().any(|entry| entry.1));
        if is_no_arm(&entry, &all) || contradicts || lacks {
            entry.iter().for_each(|limb| _ = found.remove(&limb.place));
        }
    }
    let found = found.into_iter();
    found
        .map(|(place, (kind, joint))| {
            let name = &table.columns[place].name;
            let why = format!(
                "by its name `{name}`, the arm's joint {joint} from the base: CHECK the order"
            );
            (place, (Meaning::Joint(kind, joint), why))
        })
        .collect()
}

/// Whether columns are not those of one arm: of one limb alone, of two sides, or one joint twice.
fn is_no_arm(entry: &[&Limb], all: &[Vec<String>]) -> bool {
    let says = |limb: &Limb, side: &[&str]| {
        let words = &all[limb.place];
        words.iter().any(|word| side.contains(&word.as_str()))
    };
    let has = |side: &[&str]| entry.iter().any(|limb| says(limb, side));
    let two_sides = has(&["left", "l"]) && has(&["right", "r"]);
    let first = entry.first().map(|limb| limb.order.0);
    let one_limb = entry.iter().all(|limb| Some(limb.order.0) == first);
    let bare = |limb: &Limb| {
        let mut words = all[limb.place].clone();
        words.retain(|word| !ANGLE.contains(&word.as_str()));
        words
    };
    let mut names: Vec<Vec<String>> = entry.iter().map(|limb| bare(limb)).collect();
    names.sort();
    let twice = names.windows(2).any(|pair| pair[0] == pair[1]);
    two_sides || one_limb || twice
}

/// The limb that a column's words say, where they say nothing else.
fn limb(place: usize, words: &[String]) -> Option<Limb> {
    let of = |word: &String| {
        LIMBS
            .iter()
            .position(|entry| entry.contains(&word.as_str()))
    };
    let mut entry = words.iter().filter_map(of);
    let (limb, None) = (entry.next()?, entry.next()) else {
        return None;
    };
    let known = [&TORQUE[..], &VELOCITY, &COMMAND, &ANGLE, &BESIDE].concat();
    let is_known = |word: &String| {
        of(word).is_some() || word.parse::<usize>().is_ok() || known.contains(&word.as_str())
    };
    let mut numbers = words.iter().filter_map(|word| word.parse().ok());
    let number = numbers.next().unwrap_or(0);
    let turn = words.iter().map(|word| match word.as_str() {
        "pan" => 0,
        "lift" => 2,
        _ => 1,
    });
    // the number of a limb's joint, not of a list's element
    (words.iter().all(is_known) && numbers.next().is_none() && number <= 9).then(|| Limb {
        place,
        kind: kind_of(words).unwrap_or(OfJoint::Angle),
        order: (
            limb,
            number,
            turn.fold(1, |found, entry| if entry == 1 { found } else { entry }),
        ),
    })
}

/// The columns of Motoman's letters; none where one is not there.
fn letters(all: &[Vec<String>]) -> Option<Vec<usize>> {
    let place = |letter: &&str| all.iter().position(|words| *words == [*letter]);
    LETTERS.iter().map(place).collect()
}
