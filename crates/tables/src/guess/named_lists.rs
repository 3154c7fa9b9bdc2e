//! Lists of numbers beside a list of names, as a message of joint states has them: the names say whose the numbers are, whatever
//! the order.

use std::collections::BTreeMap;

use super::Joint;
use super::groups::stem_and_numbers;
use super::names::{Meaning, OfJoint, kind_of, of_device};
use crate::table::{Cells, Table};

/// Words of a list of names.
const NAMES: [&str; 2] = ["name", "names"];
/// Words of a list of joint positions.
const POSITIONS: [&str; 4] = ["position", "positions", "pos", "angle"];

/// The words of a list's name but the last, and the number of an element.
type Element = (Vec<String>, usize);

/// An element of a list, and the last word of the list's name: `joint_names` stands beside `positions`.
fn element(name: &str) -> Option<(Element, String)> {
    let (mut front, numbers) = stem_and_numbers(name)?;
    let [number] = numbers[..] else {
        return None;
    };
    let last = front.pop()?;
    if front.last().is_some_and(|word| word == "joint") {
        front.pop();
    }
    Some(((front, number), last))
}

/// The one text of a column; none of several.
fn only(cells: &[String]) -> Option<&str> {
    let mut texts = cells.iter().filter(|cell| !cell.is_empty());
    let first = texts.next()?;
    texts.all(|cell| cell == first).then_some(first.as_str())
}

/// What columns are by the names beside them, by their place in the file; none, with the reason, where no joint of the device is
/// called so.
pub(super) fn of(table: &Table, joints: &[Joint]) -> BTreeMap<usize, (Option<Meaning>, String)> {
    let mut names: BTreeMap<Element, (&str, Option<&str>)> = BTreeMap::new();
    for column in &table.columns {
        let Cells::Texts(cells) = &column.cells else {
            continue;
        };
        if let Some((element, last)) = element(&column.name)
            && NAMES.contains(&last.as_str())
        {
            names.insert(element, (&column.name, only(cells)));
        }
    }
    let mut found = BTreeMap::new();
    for (place, column) in table.columns.iter().enumerate() {
        let Some((element, last)) = element(&column.name) else {
            continue;
        };
        let is_position = POSITIONS.contains(&last.as_str());
        let kind = match kind_of(std::slice::from_ref(&last)) {
            Some(kind) => kind,
            None if is_position => OfJoint::Angle,
            None => continue,
        };
        let Some((of, name)) = names.get(&element) else {
            continue;
        };
        let (meaning, why) = match name {
            None => (None, format!("`{of}` is not the same in all rows")),
            Some(name) if joints.is_empty() => (
                Some(Meaning::Joint(kind, element.1)),
                format!(
                    "CHECK the order: `{of}` says `{name}`; --device puts the joints in the device's"
                ),
            ),
            Some(name) => match of_device(name, joints) {
                Some(joint) => {
                    let slides = joints[joint].1 && kind == OfJoint::Angle;
                    let kind = if slides { OfJoint::Slide } else { kind };
                    (
                        Some(Meaning::Joint(kind, joint + 1)),
                        format!("`{of}` says `{name}`, the device's joint {}", joint + 1),
                    )
                }
                None => (
                    None,
                    format!("`{of}` says `{name}`, which is no joint of the device"),
                ),
            },
        };
        found.insert(place, (meaning, why));
    }
    found
}

#[cfg(test)]
mod tests {
    use crate::{Reading, guess, table_from_bytes};

    /// ROS lists joints by the alphabet; a gripper is none of the arm's.
    #[test]
    fn joints_are_those_that_the_names_beside_them_say() {
        let row = |t: f64, q: [f64; 3]| {
            format!(
                "{{\"t_s\":{t},\"joint_states\":{{\"name\":[\"elbow\",\"finger\",\"shoulder\"],\"position\":[{},{},{}],\"effort\":[1,2,3]}}}}\n",
                q[0], q[1], q[2]
            )
        };
        let text = row(0.0, [0.1, 0.2, 0.3]) + &row(0.1, [0.4, 0.5, 0.6]);
        let table = table_from_bytes(text.into(), "log.jsonl", &Reading::default()).unwrap();
        let joints = [("shoulder".to_owned(), false), ("elbow".to_owned(), false)];
        let proposal = guess(std::slice::from_ref(&table), &joints);
        let is_from = |log: &str, from: &str| {
            proposal.contains(&format!(
                "log = \"{log}\"\nfrom = \"joint_states.{from}\"\n"
            ))
        };
        assert!(is_from("theta1_rad", "position[3]"), "{proposal}");
        assert!(is_from("theta2_rad", "position[1]"), "{proposal}");
        assert!(is_from("torque1_nm", "effort[3]"), "{proposal}");
        assert!(!proposal.contains("log = \"theta3"), "{proposal}");
        assert!(
            proposal.contains("which is no joint of the device"),
            "{proposal}"
        );
        let blind = guess(&[table], &[]);
        assert!(blind.contains("CHECK the order"), "{blind}");
    }
}
