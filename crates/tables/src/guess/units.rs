//! The unit of a column: what the file says, else what the size of its numbers allows.

use std::f64::consts::TAU;

use super::Proposal;
use super::names::{Meaning, OfJoint, has_unit, unit_at_end};
use crate::mapping::{Dimension, Unit, dimension_of};
use crate::table::{Column, Table};

/// How a column's numbers are scaled.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) enum Scale {
    /// In the log's unit.
    #[default]
    None,
    /// In another unit.
    Unit(String),
    /// Counts of an encoder, with how many a turn are not known.
    Counts,
}

/// More than this \[rad\] no joint turns without a number in degrees being likelier.
const MOST_RAD: f64 = 1.01 * TAU;
/// More than this \[m\] no handle is away from the base.
const MOST_M: f64 = 20.0;
/// Whole numbers beyond this are counts, not degrees.
const MOST_DEG: f64 = 1080.0;

/// Finds the scale of each column; columns of one kind in one file have one.
pub(super) fn scales(found: &mut [Proposal], run: &[Table]) {
    let kinds: Vec<Kind> = found.iter().map(|own| Kind::of(own, run)).collect();
    for index in 0..found.len() {
        if !has_unit(&found[index].meaning) {
            continue;
        }
        let own = &found[index];
        let column = &run[own.file].columns[own.column];
        let wanted = kinds[index].dimension;
        let fits = stated(column).filter(|(_, unit)| Some(unit.dimension) == wanted);
        let unknown = column.unit.as_deref().or_else(|| in_brackets(&column.name));
        let unknown = unknown.filter(|word| Unit::parse(word).is_none());
        let (scale, why) = match fits {
            Some((_, unit)) if unit.factor == 1.0 && unit.zero == 0.0 => {
                (Scale::None, "the file says the log's unit".to_owned())
            }
            Some((word, _)) => (
                Scale::Unit(word.to_owned()),
                format!("the file says {word}"),
            ),
            None => {
                // a column that says its unit says nothing of those that are silent
                let alike = kinds.iter();
                let alike = alike.filter(|kind| **kind == kinds[index] && !kind.is_said);
                let largest = alike.clone().map(|kind| kind.largest).fold(0.0, f64::max);
                let whole = alike.clone().all(|kind| kind.is_whole);
                let step = kinds[index].step;
                by_size(wanted, largest, whole, step)
            }
        };
        let own = &mut found[index];
        own.scale = scale;
        let unknown = unknown
            .filter(|_| wanted.is_some())
            .map_or_else(String::new, |word| {
                format!("the file says `{word}`, which is NO KNOWN UNIT: say what it is; ")
            });
        own.why = format!("{}; {unknown}{why}", own.why);
    }
}

/// What stands in brackets at the end of a name and is no number of an element.
pub(super) fn in_brackets(name: &str) -> Option<&str> {
    let open = name.find(['[', '('])?;
    let inner = name.get(open + 1..name.len() - 1)?.trim();
    let is_closed = name.ends_with([']', ')']);
    (is_closed && inner.chars().any(char::is_alphabetic)).then_some(inner)
}

/// The unit that a file says of a column: in its own cell, or at the end of the name.
pub(crate) fn stated(column: &Column) -> Option<(&str, Unit)> {
    // the log's own name of time
    if column.name == "t_s" && column.unit.is_none() {
        return Some(("s", Unit::parse("s")?));
    }
    let word = column
        .unit
        .as_deref()
        .or_else(|| unit_at_end(&column.name))?;
    Some((word, Unit::parse(word)?))
}

/// What columns must share to share a unit, and the size of their numbers.
#[derive(Debug, Clone)]
struct Kind {
    file: usize,
    sort: u8,
    dimension: Option<Dimension>,
    /// Whether the file says its unit.
    is_said: bool,
    largest: f64,
    is_whole: bool,
    /// Median distance between rows.
    step: f64,
}

impl PartialEq for Kind {
    fn eq(&self, other: &Self) -> bool {
        (self.file, self.sort, self.dimension) == (other.file, other.sort, other.dimension)
    }
}

impl Kind {
    fn of(own: &Proposal, run: &[Table]) -> Self {
        let sort = match &own.meaning {
            Meaning::Log(_) => 0,
            Meaning::Joint(OfJoint::Angle | OfJoint::Command, _) => 1,
            Meaning::Joint(OfJoint::Slide, _) => 2,
            Meaning::Joint(OfJoint::Torque, _) => 3,
            Meaning::Joint(OfJoint::Velocity, _) => 4,
            Meaning::Position(_) => 5,
            Meaning::Angle(_) | Meaning::Vector(_) => 6,
            Meaning::Quaternion(_) | Meaning::Matrix(_) | Meaning::Pose(_) => 7,
        };
        let dimension = match &own.meaning {
            Meaning::Angle(_) | Meaning::Vector(_) => Some(Dimension::Angle),
            other => dimension_of(&other.to_string()),
        };
        let column = &run[own.file].columns[own.column];
        let numbers = column.cells.numbers();
        let said = stated(column);
        Self {
            file: own.file,
            sort,
            dimension,
            is_said: said.is_some_and(|(_, unit)| Some(unit.dimension) == dimension),
            ..Self::of_numbers(numbers.unwrap_or_default())
        }
    }

    fn of_numbers(numbers: &[f64]) -> Self {
        let read = || numbers.iter().filter(|number| !number.is_nan());
        let steps = numbers.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let mut steps: Vec<f64> = steps.filter(|step| step.is_finite()).collect();
        steps.sort_by(f64::total_cmp);
        Self {
            file: 0,
            sort: 0,
            dimension: None,
            is_said: false,
            largest: read().fold(0.0, |most, number| most.max(number.abs())),
            is_whole: read().all(|number| number.fract() == 0.0),
            step: steps.get(steps.len() / 2).copied().unwrap_or(0.0),
        }
    }
}

/// The unit of a column of time.
pub(super) fn time_unit(column: &Column) -> String {
    let said = column.unit.as_deref().or_else(|| unit_at_end(&column.name));
    let is_time =
        |word: &&str| Unit::parse(word).is_some_and(|unit| unit.dimension == Dimension::Time);
    if let Some(word) = said.filter(is_time) {
        return word.to_owned();
    }
    let kind = Kind::of_numbers(column.cells.numbers().unwrap_or_default());
    match by_size(
        Some(Dimension::Time),
        kind.largest,
        kind.is_whole,
        kind.step,
    )
    .0
    {
        Scale::Unit(word) => word,
        Scale::None | Scale::Counts => "s".to_owned(),
    }
}

fn by_size(
    dimension: Option<Dimension>,
    largest: f64,
    is_whole: bool,
    step: f64,
) -> (Scale, String) {
    let unit = |word: &str, why: String| (Scale::Unit(word.to_owned()), why);
    match dimension {
        Some(Dimension::Angle) if is_whole && largest > MOST_DEG => (
            Scale::Counts,
            format!("whole numbers up to {largest} look like counts of an encoder"),
        ),
        Some(Dimension::Angle) if largest > MOST_RAD => unit(
            "deg",
            format!("up to {largest:.1}, which is more than a turn in rad"),
        ),
        Some(Dimension::Angle) => (
            Scale::None,
            format!("up to {largest:.3}, taken for rad: CHECK that it is not degrees"),
        ),
        Some(Dimension::Length) if largest > MOST_M => {
            unit("mm", format!("up to {largest:.1}, which is far in m"))
        }
        Some(Dimension::Length) => (Scale::None, format!("up to {largest:.3}, taken for m")),
        Some(Dimension::Time) => {
            // seconds since 1970 are 1.7e9 now
            let epochs = [(1e17, "ns"), (1e14, "us"), (1e11, "ms")];
            match epochs.iter().find(|(least, _)| largest > *least) {
                Some((_, word)) => unit(
                    word,
                    format!("up to {largest:e}, a time since 1970 in {word}"),
                ),
                // logs have 1 to 1000 rows a second
                None if is_whole && step >= 100.0 => {
                    let word = match step {
                        1e6.. => "ns",
                        1e3.. => "us",
                        _ => "ms",
                    };
                    unit(word, format!("whole numbers, {step} apart: CHECK the unit"))
                }
                None if is_whole && step > 0.0 => (
                    Scale::None,
                    format!(
                        "whole numbers, {step} apart, taken for s: CHECK that they are no ms or us"
                    ),
                ),
                None => (Scale::None, "taken for s".to_owned()),
            }
        }
        Some(Dimension::AngularVelocity) if largest > 30.0 => {
            unit("deg/s", format!("up to {largest:.1}"))
        }
        _ => (Scale::None, "taken for the log's unit".to_owned()),
    }
}
