//! Columns whose names end in the letters of a place or a turn, behind words that are not known: `trk_x`, `p_RS_R_x`.

use std::collections::BTreeMap;

use super::lists::{COMMAND, FOREIGN, POSITION, TORQUE, VELOCITY};
use super::names::{Meaning, words};
use super::units::in_brackets;
use crate::mapping::{Dimension, Unit};
use crate::table::Table;

/// Words of what has three parts and is no place.
const NO_PLACE: [&str; 22] = [
    "v",
    "w",
    "linear",
    "angular",
    "twist",
    "acc",
    "mag",
    "wrench",
    "omega",
    "cov",
    "covariance",
    "std",
    "sigma",
    "var",
    "scale",
    "gravity",
    "normal",
    "bias",
    "rate",
    "vector",
    "marker error",
    "jerk",
];
/// Words of a turn.
pub(super) const TURN: [&str; 6] = [
    "orientation",
    "rotation",
    "rot",
    "quat",
    "quaternion",
    "euler",
];

/// What the letters at the end of names are parts of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Whole {
    Place,
    Quaternion,
    Vector,
    Angles,
}

impl Whole {
    const ALL: [Self; 4] = [Self::Place, Self::Quaternion, Self::Vector, Self::Angles];

    /// The last words of its parts, in order; several ways to say them.
    fn ends(self) -> &'static [&'static [&'static str]] {
        match self {
            Self::Place => &[
                &["x", "y", "z"],
                &["px", "py", "pz"],
                &["tx", "ty", "tz"],
                &["posx", "posy", "posz"],
            ],
            Self::Quaternion => &[&["qw", "qx", "qy", "qz"]],
            Self::Vector => &[&["rx", "ry", "rz"]],
            Self::Angles => &[&["roll", "pitch", "yaw"]],
        }
    }

    fn part(self, part: usize) -> Meaning {
        match self {
            Self::Place => Meaning::Position(part),
            Self::Quaternion => Meaning::Quaternion(part),
            Self::Vector => Meaning::Vector(part),
            Self::Angles => Meaning::Angle(part),
        }
    }

    fn is(self, meaning: &Meaning) -> bool {
        *meaning == self.part(0)
    }

    fn is_turn(self) -> bool {
        self != Self::Place
    }
}

/// Parts with the same words before their letters.
struct Group {
    whole: Whole,
    front: Vec<String>,
    columns: Vec<usize>,
}

impl Group {
    fn says(&self, list: &[&str]) -> bool {
        self.front.iter().any(|word| list.contains(&word.as_str()))
    }
}

/// What columns without a meaning are, by their place in the file; without one the reason why not.
pub(super) fn of(
    table: &Table,
    meanings: &[Option<Meaning>],
) -> BTreeMap<usize, (Option<Meaning>, String)> {
    let groups = groups(table, meanings);
    let has = |whole: Whole| meanings.iter().flatten().any(|item| whole.is(item));
    let mut found = BTreeMap::new();
    let mut propose = |group: &Group, why: &dyn Fn(&str) -> String| {
        for (part, column) in group.columns.iter().enumerate() {
            let why = why(&table.columns[*column].name);
            found.insert(*column, (Some(group.whole.part(part)), why));
        }
    };
    let mut doubts: Vec<&Group> = Vec::new();
    let mut place: Option<&[String]> = None;
    for whole in Whole::ALL {
        if has(whole) || (whole.is_turn() && Whole::ALL[1..].iter().any(|turn| has(*turn))) {
            continue;
        }
        let item: Vec<&Group> = groups.iter().filter(|group| group.whole == whole).collect();
        let known: Vec<&&Group> = item.iter().filter(|group| group.says(&POSITION)).collect();
        let beside = item.iter().find(|group| {
            place.is_some_and(|place| whole.is_turn() && group.front.as_slice() == place)
        });
        match (&item[..], beside, &known[..]) {
            ([], ..) => {}
            (_, Some(group), _) => {
                propose(group, &|name| {
                    format!("by its name `{name}`, beside the place")
                });
            }
            (.., [first, ..]) => {
                place = Some(&first.front);
                for group in &known {
                    propose(group, &|name| format!("by its name `{name}`"));
                }
            }
            ([group], ..) => {
                place = place.or(Some(&group.front));
                let letters = whole.ends()[0].join(", ");
                let front = group.front.join(" ");
                let why = format!(
                    "UNSURE: `{front}` is not known, but nothing else has {letters}: CHECK"
                );
                propose(group, &|_| why.clone());
            }
            _ => doubts.extend(item),
        }
    }
    for group in doubts {
        for column in &group.columns {
            let why = "several may be the handle's, and no name says which: choose one".to_owned();
            found.insert(*column, (None, why));
        }
    }
    found
}

/// Whole groups of numbers whose names and units do not say that they are something else.
fn groups(table: &Table, meanings: &[Option<Meaning>]) -> Vec<Group> {
    let others = [&FOREIGN[..], &TORQUE, &VELOCITY, &COMMAND, &NO_PLACE].concat();
    let mut parts: BTreeMap<(Whole, usize, Vec<String>), Vec<Option<usize>>> = BTreeMap::new();
    for (place, column) in table.columns.iter().enumerate() {
        if meanings[place].is_some() || column.cells.numbers().is_none() {
            continue;
        }
        let mut front = words(&column.name);
        let Some(last) = front.pop() else {
            continue;
        };
        // a target is both what is seen and what was commanded
        let is_other =
            |word: &String| others.contains(&word.as_str()) && !POSITION.contains(&word.as_str());
        if front.iter().any(is_other) {
            continue;
        }
        let says_turn = front.iter().any(|word| TURN.contains(&word.as_str()));
        let unit = column.unit.as_deref().or_else(|| in_brackets(&column.name));
        let is_length = unit.is_none_or(|unit| {
            Unit::parse(unit).is_some_and(|unit| unit.dimension == Dimension::Length)
        });
        for whole in Whole::ALL {
            if whole == Whole::Place && (says_turn || !is_length) {
                continue;
            }
            for (way, ends) in whole.ends().iter().enumerate() {
                if let Some(part) = ends.iter().position(|end| *end == last) {
                    let group = parts.entry((whole, way, front.clone()));
                    let group = group.or_insert_with(|| vec![None; ends.len()]);
                    group[part].get_or_insert(place);
                }
            }
        }
        // three angles without a real part
        if says_turn && let Some(part) = ["x", "y", "z"].iter().position(|end| *end == last) {
            let group = parts.entry((Whole::Vector, usize::MAX, front));
            group.or_insert_with(|| vec![None; 3])[part].get_or_insert(place);
        }
    }
    let parts = parts.into_iter();
    let whole = parts.filter_map(|((whole, _, front), columns)| {
        Some(Group {
            whole,
            front,
            columns: columns.into_iter().collect::<Option<_>>()?,
        })
    });
    whole.collect()
}
