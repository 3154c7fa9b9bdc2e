//! Tables of what the data could not have shown, or only from some size on.

use haptical_diagnosis::Diagnosis;
use haptical_report::{Block, Cell, Table};

use crate::diagnose::quantity::Quantity;
use crate::diagnose::words::named_at;
use crate::error::Error;

/// Smallest sizes that would have been noticed: effects by joints.
pub(in crate::diagnose::page) fn detectable(diagnosis: &Diagnosis) -> Result<Option<Block>, Error> {
    let all = &diagnosis.detectable;
    let mut joints: Vec<usize> = all.iter().filter_map(|entry| entry.joint).collect();
    joints.sort_unstable();
    joints.dedup();
    let mut columns = vec!["effect".to_owned(), "parameter".to_owned()];
    columns.extend(joints.iter().map(|joint| format!("joint {joint}")));
    let of_device = all.iter().any(|entry| entry.joint.is_none());
    if of_device {
        columns.push("device".to_owned());
    }
    let mut table = Table::with_heads("", &columns.join(" | "));
    let mut done: Vec<(&str, &str)> = Vec::new();
    for entry in all {
        let key = (entry.effect.as_str(), entry.parameter.as_str());
        if done.contains(&key) {
            continue;
        }
        done.push(key);
        let at = |joint: Option<usize>| {
            all.iter()
                .find(|other| {
                    (other.effect.as_str(), other.parameter.as_str()) == key && other.joint == joint
                })
                .map_or(Cell::Missing, |found| {
                    Quantity::new(key.0, key.1, found.value)
                        .short(found.value)
                        .into()
                })
        };
        let mut row: Vec<Cell> = vec![
            key.0.into(),
            Quantity::new(key.0, key.1, entry.value).words.into(),
        ];
        row.extend(joints.iter().map(|joint| at(Some(*joint))));
        if of_device {
            row.push(at(None));
        }
        table.push(row)?;
    }
    table.notes = vec![
        "An effect of this size would have been noticed in four of five recordings like this one; \
         of a stiffness, any smaller one."
            .to_owned(),
    ];
    Ok(Some(Block::Table(table)))
}

/// What the model swallows.
pub(in crate::diagnose::page) fn invisible(diagnosis: &Diagnosis) -> Result<Option<Block>, Error> {
    let mut table = Table::with_heads("", "effect | why | what it would falsify");
    for entry in &diagnosis.invisible {
        table.push(vec![
            named_at(&entry.effect, entry.joint).into(),
            entry.why.as_str().into(),
            entry.would_bias.as_str().into(),
        ])?;
    }
    Ok(Some(Block::Table(table)))
}

/// What cannot be tested, and why.
pub(in crate::diagnose::page) fn untestable(diagnosis: &Diagnosis) -> Result<Option<Block>, Error> {
    let mut table = Table::with_heads("", "effect | joints | why");
    for entry in &diagnosis.untestable {
        let joints: Vec<String> = entry.joints.iter().map(ToString::to_string).collect();
        let joints = if joints.is_empty() {
            Cell::Missing
        } else {
            joints.join(", ").into()
        };
        table.push(vec![
            entry.effect.as_str().into(),
            joints,
            entry.why.as_str().into(),
        ])?;
    }
    Ok(Some(Block::Table(table)))
}

#[cfg(test)]
mod tests {
    use super::super::only;
    use super::*;
    use crate::diagnose::example_tests::named;

    #[test]
    fn detectable_sizes_stand_under_their_joints() {
        let mut diagnosis = named();
        let mut device = diagnosis.detectable[0].clone();
        device.effect = "cable-latency".to_owned();
        device.parameter = "delay_s".to_owned();
        device.joint = None;
        device.value = 1.6e-5;
        diagnosis.detectable.push(device);
        let found = only(detectable(&diagnosis).unwrap().unwrap());
        let heads: Vec<&str> = found.columns.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(
            heads,
            ["effect", "parameter", "joint 1", "joint 2", "device"]
        );
        let texts = |row: usize| -> Vec<Cell> { found.rows[row].clone() };
        let cells = |all: [&str; 5]| {
            all.map(|text| {
                if text.is_empty() {
                    Cell::Missing
                } else {
                    text.into()
                }
            })
            .to_vec()
        };
        assert_eq!(
            texts(0),
            cells(["backlash", "width", "20.0 µrad", "30.0 µrad", ""])
        );
        assert_eq!(
            texts(1),
            cells(["cable-latency", "delay", "", "", "16.0 µs"])
        );
    }
}
