//! Names in a header that are close to a name of the log format.

use crate::column::Role;
use crate::shape::LogShape;

/// A column that may be meant as another one.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct NearMiss {
    /// Name in the header.
    pub found: String,
    /// Position of the column, counted from 1.
    pub column_number: usize,
    /// Name of the column in the log format.
    pub wanted: String,
    /// Whether the name speaks of another unit, so that the readings must be converted too.
    pub convert: bool,
}

/// Units that a name may end in, apart from those of the log format.
const UNITS: [&str; 25] = [
    "rad", "radian", "radians", "m", "s", "nm", "n", "degc", "deg", "degree", "degrees", "mm",
    "cm", "um", "ms", "us", "ns", "sec", "seconds", "c", "k", "kn", "nmm", "position", "pos",
];

/// The column of the log format that `found` may be meant as.
pub(crate) fn near_miss(found: &str, column_number: usize, shape: &LogShape) -> Option<NearMiss> {
    let lower = found.to_lowercase();
    let (words, index) = words_and_index(&lower)?;
    let (&stem, units) = words.split_first()?;
    if units.len() > 1 || units.iter().any(|unit| !UNITS.contains(unit)) {
        return None;
    }
    let wanted = wanted_name(stem, index, shape)?;
    let unit = wanted.rsplit_once('_').map_or("", |(_, unit)| unit);
    let convert = units.iter().any(|&given| same_unit(given, unit) != unit);
    Some(NearMiss {
        found: found.to_owned(),
        column_number,
        wanted,
        convert,
    })
}

/// The log format's name for a unit written otherwise; `joint1_position` speaks of no unit.
fn same_unit<'a>(given: &'a str, unit: &'a str) -> &'a str {
    match given {
        "radian" | "radians" => "rad",
        "sec" | "seconds" => "s",
        "c" => "degc",
        "position" | "pos" => unit,
        other => other,
    }
}

/// `theta_1 [deg]` to the words `theta`, `deg` and the number 1; no name has two numbers.
fn words_and_index(lower: &str) -> Option<(Vec<&str>, Option<usize>)> {
    let mut words = Vec::new();
    let mut index = None;
    for part in lower.split(|letter: char| !letter.is_alphanumeric()) {
        let mut rest = part;
        while let Some(first) = rest.chars().next() {
            let is_digit = first.is_ascii_digit();
            let end = rest
                .find(|letter: char| letter.is_ascii_digit() != is_digit)
                .unwrap_or(rest.len());
            let (word, after) = rest.split_at(end);
            if !is_digit {
                words.push(word);
            } else if index.replace(word.parse().ok()?).is_some() {
                return None;
            }
            rest = after;
        }
    }
    Some((words, index))
}

fn wanted_name(stem: &str, index: Option<usize>, shape: &LogShape) -> Option<String> {
    let joint = || {
        let joint = index?.checked_sub(1)?;
        (joint < shape.joints.len()).then_some(joint)
    };
    let plain = |name: &str| index.is_none().then(|| name.to_owned());
    match stem {
        "theta" | "th" | "joint" | "jnt" | "j" | "q" | "angle" => {
            Some(Role::Joint(joint()?).name(shape))
        }
        "out" | "output" | "external" | "ext" => Some(Role::Output(joint()?).name(shape)),
        "torque" | "tau" => Some(Role::Torque(joint()?).name(shape)),
        "cable" | "distance" | "dist" => {
            let cable = index.unwrap_or(1).checked_sub(1)?;
            (cable < shape.cable_count).then(|| Role::Cable(cable).name(shape))
        }
        "t" | "time" | "timestamp" => plain("t_s"),
        "x" => plain("x_m"),
        "y" => plain("y_m"),
        "z" => plain("z_m"),
        "qw" | "qx" | "qy" | "qz" | "run" | "contact" | "plane" | "tool" => plain(stem),
        "fx" => plain("fx_n"),
        "fy" => plain("fy_n"),
        "fz" => plain("fz_n"),
        "temp" | "temperature" => plain("temp_degc"),
        _ => None,
    }
}

/// Most names that a message lists.
const MOST_NAMES: usize = 12;

/// Names in backticks, separated by commas; of many the first.
pub(crate) fn list(names: &[String]) -> String {
    let quoted: Vec<String> = names
        .iter()
        .take(MOST_NAMES)
        .map(|name| format!("`{name}`"))
        .collect();
    let mut text = quoted.join(", ");
    if let Some(more @ 1..) = names.len().checked_sub(MOST_NAMES) {
        text.push_str(&format!(" and {more} more"));
    }
    text
}

/// What to do about near misses, as the end of a sentence.
pub(crate) fn advice(near_misses: &[NearMiss]) -> String {
    if near_misses.is_empty() {
        return "; add them, or check that the device file is the right one".to_owned();
    }
    let each: Vec<String> = near_misses.iter().map(NearMiss::advice).collect();
    format!("; {}", each.join(", "))
}

impl NearMiss {
    /// What to do about it.
    pub(crate) fn advice(&self) -> String {
        let Self {
            found,
            column_number,
            wanted,
            convert,
        } = self;
        let unit = wanted.rsplit_once('_').map_or("", |(_, unit)| unit);
        if *convert {
            format!("convert column {column_number} `{found}` to {unit} and rename it `{wanted}`")
        } else if unit.is_empty() || found.to_lowercase().contains(unit) {
            format!("rename column {column_number} `{found}` to `{wanted}`")
        } else {
            format!("rename column {column_number} `{found}` to `{wanted}` if it is in {unit}")
        }
    }
}
