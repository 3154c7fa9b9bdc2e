//! Keys of a joint state of ROS 2 to the names of a log: `name`, `position`, `velocity`, `effort`, the stamp.

use super::columns::{JsonCell, JsonColumns};
use crate::column::Role;
use crate::error::place::Place;
use crate::error::{DataError, Fault};
use crate::shape::LogShape;

/// Lists with an element for each joint.
const LISTS: [&str; 3] = ["position", "velocity", "effort"];
/// Stamps, and their parts in seconds and nanoseconds.
const STAMPS: [(&str, &str); 4] = [
    ("header.stamp.sec", "header.stamp.nanosec"),
    ("header.stamp.secs", "header.stamp.nsecs"),
    ("stamp.sec", "stamp.nanosec"),
    ("stamp.secs", "stamp.nsecs"),
];

/// Gives the columns the names of a log.
pub(super) fn rename(
    columns: &mut JsonColumns,
    name: &str,
    shape: &LogShape,
) -> Result<(), DataError> {
    let refuse = |what: String, row: usize| {
        let line = columns.lines.get(row).copied().unwrap_or(1);
        Place::line(name, line).error(Fault::NotALog {
            what,
            advice: "give one element for each joint of the device, in its order, or their names in `name`".to_owned(),
        })
    };
    let mut added = Vec::new();
    for list in LISTS {
        let elements = elements(columns, list);
        if elements.is_empty() {
            continue;
        }
        let names = self::elements(columns, "name");
        let mut joints = vec![vec![JsonCell::None; columns.lines.len()]; shape.joints.len()];
        for row in 0..columns.lines.len() {
            let there = elements
                .iter()
                .take_while(|&&column| !matches!(columns.cells[column][row], JsonCell::None));
            let count = there.count();
            if count == 0 {
                continue;
            }
            let order =
                order(columns, &names, row, count, shape).map_err(|what| refuse(what, row))?;
            for (joint, place) in order.into_iter().enumerate() {
                joints[joint][row] = columns.cells[elements[place]][row].clone();
            }
        }
        added.extend(
            joints
                .into_iter()
                .enumerate()
                .map(|(joint, cells)| (name_of(list, joint, shape), cells)),
        );
    }
    if let Some(time) = time(columns) {
        added.push(("t_s".to_owned(), time));
    }
    if added.is_empty() {
        return Ok(());
    }
    let is_part = |own: &str| {
        LISTS.iter().chain(&["name"]).any(|list| {
            own.strip_prefix(list)
                .is_some_and(|rest| rest.starts_with('['))
        })
    };
    columns
        .retain(|own| !is_part(own) && !own.starts_with("header.") && !own.starts_with("stamp."));
    for (own, cells) in added {
        match columns.find(&own) {
            // the log's own name is the more exact one
            Some(_) => {}
            None => columns.add_column(own, cells),
        }
    }
    Ok(())
}

/// The columns of a list's elements, in their order.
fn elements(columns: &JsonColumns, list: &str) -> Vec<usize> {
    let numbered = (1..).map_while(|number| columns.find(&format!("{list}[{number}]")));
    numbered.collect()
}

/// For each joint of the device the place in the list of a row.
fn order(
    columns: &JsonColumns,
    names: &[usize],
    row: usize,
    count: usize,
    shape: &LogShape,
) -> Result<Vec<usize>, String> {
    let of_row = names
        .iter()
        .map_while(|&column| match &columns.cells[column][row] {
            JsonCell::Text(name) => Some(name.as_str()),
            _ => None,
        });
    let of_row: Vec<&str> = of_row.collect();
    if of_row.is_empty() {
        let joints = shape.joints.len();
        return match count == joints {
            true => Ok((0..joints).collect()),
            false => Err(format!(
                "a list of {count} elements, and the device has {joints} joints"
            )),
        };
    }
    if of_row.len() != count {
        return Err(format!(
            "a list of {count} elements for {} names",
            of_row.len()
        ));
    }
    let place = |joint: &str| {
        let place = of_row.iter().position(|name| *name == joint);
        place.ok_or_else(|| format!("the object does not name the joint `{joint}`"))
    };
    shape
        .joints
        .iter()
        .map(|joint| place(&joint.name))
        .collect()
}

/// The log's name of a joint's element.
fn name_of(list: &str, joint: usize, shape: &LogShape) -> String {
    match list {
        "position" => Role::Joint(joint).name(shape),
        "effort" => Role::Torque(joint).name(shape),
        _ => {
            let unit = shape.joints.get(joint).map_or("rad", |joint| joint.unit());
            format!("velocity{}_{unit}_per_s", joint + 1)
        }
    }
}

/// Time from the first stamp on \[s\].
fn time(columns: &JsonColumns) -> Option<Vec<JsonCell>> {
    let parts = STAMPS.iter().find_map(|(seconds, nanoseconds)| {
        Some([columns.find(seconds)?, columns.find(nanoseconds)?])
    })?;
    let [seconds, nanoseconds] = parts.map(|column| &columns.cells[column]);
    let number = |cell: &JsonCell| match cell {
        JsonCell::Number(number) => *number,
        _ => f64::NAN,
    };
    let stamps = seconds.iter().zip(nanoseconds);
    // seconds are whole numbers, so their differences are exact
    let first = seconds.first().map(number)?;
    let time = stamps.map(|(seconds, nanoseconds)| {
        let time = number(seconds) - first + number(nanoseconds) / 1e9;
        match time.is_nan() {
            true => JsonCell::None,
            false => JsonCell::Number(time),
        }
    });
    let time: Vec<JsonCell> = time.collect();
    let offset = time.iter().find_map(|cell| match cell {
        JsonCell::Number(time) => Some(*time),
        _ => None,
    })?;
    let shifted = time.into_iter().map(|cell| match cell {
        JsonCell::Number(time) => JsonCell::Number(time - offset),
        other => other,
    });
    Some(shifted.collect())
}
