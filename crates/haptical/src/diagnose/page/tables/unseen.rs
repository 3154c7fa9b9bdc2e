//! Tables of effects that the data could not have shown, or only from some size on.

use std::collections::BTreeSet;

use haptical_diagnosis::Diagnosis;
use haptical_report::{Cell, Table};

use crate::diagnose::quantity::Quantity;
use crate::diagnose::words::{column, joints, named_at};
use crate::error::Error;

/// Smallest sizes that would have been noticed: effects by joints.
pub(in crate::diagnose::page) fn detectable(diagnosis: &Diagnosis) -> Result<Table, Error> {
    let all = &diagnosis.detectable;
    let joints = joints(all.iter().map(|entry| entry.joint));
    let mut columns = vec!["effect".to_owned(), "parameter".to_owned()];
    columns.extend(joints.iter().map(|joint| column(*joint)));
    let mut table = Table::with_heads("", &columns.join(" | "));
    let mut done = BTreeSet::new();
    for entry in all {
        let (effect, parameter) = (entry.effect.as_str(), entry.parameter.as_str());
        if !done.insert((effect, parameter)) {
            continue;
        }
        let quantity = |value| Quantity::new(effect, parameter, value);
        let mut row: Vec<Cell> = vec![effect.into(), quantity(entry.value).words.into()];
        row.extend(joints.iter().map(|joint| {
            let mut same = all.iter().filter(|other| other.joint == *joint);
            let found =
                same.find(|other| (&*other.effect, &*other.parameter) == (effect, parameter));
            found.map_or(Cell::Missing, |found| {
                quantity(found.value).short(found.value).into()
            })
        }));
        table.push(row)?;
    }
    Ok(table.with_note(
        "An effect of this size would have been noticed in four of five recordings like this one; \
         of a stiffness, any smaller one.",
    ))
}

/// Effects that the model absorbs.
pub(in crate::diagnose::page) fn invisible(diagnosis: &Diagnosis) -> Result<Table, Error> {
    let rows = diagnosis.invisible.iter().map(|entry| {
        let named = named_at(&entry.effect, entry.joint).into();
        vec![named, (&entry.why).into(), (&entry.would_bias).into()]
    });
    Ok(Table::with_heads("", "effect | why | what it would falsify").with_rows(rows)?)
}

/// Effects that cannot be tested, and why.
pub(in crate::diagnose::page) fn untestable(diagnosis: &Diagnosis) -> Result<Table, Error> {
    let rows = diagnosis.untestable.iter().map(|entry| {
        let joints: Vec<String> = entry.joints.iter().map(ToString::to_string).collect();
        let joints = match joints.join(", ").as_str() {
            "" => Cell::Missing,
            joints => joints.into(),
        };
        vec![(&entry.effect).into(), joints, (&entry.why).into()]
    });
    Ok(Table::with_heads("", "effect | joints | why").with_rows(rows)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example_tests::named;

    #[test]
    fn detectable_sizes_are_under_their_joints() {
        let mut diagnosis = named();
        let mut device = diagnosis.detectable[0].clone();
        device.effect = "cable-latency".to_owned();
        device.parameter = "delay_s".to_owned();
        device.joint = None;
        device.value = 1.6e-5;
        diagnosis.detectable.push(device);
        let found = detectable(&diagnosis).unwrap();
        let heads: Vec<&str> = found.columns().iter().map(|c| c.name.as_str()).collect();
        assert_eq!(
            heads,
            ["effect", "parameter", "joint 1", "joint 2", "device"]
        );
        let texts = |row: usize| -> Vec<Cell> { found.rows()[row].clone() };
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
