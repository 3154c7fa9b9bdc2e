//! Reads and writes `[[effect]]` tables.

use std::collections::BTreeMap;

use toml_edit::{Array, ArrayOfTables, DocumentMut, InlineTable, Item, Table, Value, value};

use crate::device::effect::DeviceEffect;
use crate::device::surroundings::JointCompliance;
use crate::file::reader::Section;
use crate::{DeviceFileError, JointType};

type Result<T> = std::result::Result<T, DeviceFileError>;

/// Key of the list.
const KEY: &str = "effect";
/// The effect that is a number of the base model.
const COMPLIANCE: &str = "joint-compliance";
/// Another name of it.
const LINK_COMPLIANCE: &str = "link-compliance";
/// Keys that are no parameters.
const OWN_KEYS: [&str; 5] = ["name", "joint", "fit", "ci95", "confusable_with"];
/// Beginning of the parameters that are lists.
const LIST: &str = "coefficients_";
/// Parameter that is a word in the file: the side that leads where the other stays behind.
const DRIVEN_BY: &str = "driven_by";
/// Its words, in the order of its numbers; the last three of a play alone.
const SIDES: [&str; 5] = [
    "motor",
    "hand",
    "load",
    "motor-read-at-link",
    "hand-read-at-motor",
];
/// The play, which may follow the load.
const BACKLASH: &str = "backlash";

/// Effects of a device file; joint compliances go to `compliance`, one entry for each joint.
pub(crate) fn read_effects(
    root: &Section<'_, '_>,
    joints: &[JointType],
    compliance: &mut Vec<JointCompliance>,
) -> Result<Vec<DeviceEffect>> {
    let mut effects: Vec<DeviceEffect> = Vec::new();
    for section in root.tables(KEY, 1)? {
        let effect = read_effect(&section, joints.len())?;
        if is_compliance(&effect.name) {
            yield_to(&section, &effect, joints, compliance)?;
            continue;
        }
        let is_same = |other: &DeviceEffect| {
            (&other.name, other.joint, &other.numbers)
                == (&effect.name, effect.joint, &effect.numbers)
        };
        if effects.iter().any(is_same) {
            let found = format!("`{}` once more", effect.label());
            return Err(section.refuse("name", found, "an effect is written once: delete one"));
        }
        effects.push(effect);
    }
    Ok(effects)
}

fn read_effect(section: &Section<'_, '_>, joints: usize) -> Result<DeviceEffect> {
    let advice = "give the name of an effect; `haptical diagnose --list` has them all";
    let name = section.text("name")?;
    let name = name.ok_or_else(|| section.missing("name", advice))?;
    let joint = match section.number("joint")? {
        None => None,
        Some(number) if number.fract() == 0.0 && (1.0..=joints as f64).contains(&number) => {
            Some(number as usize - 1)
        }
        Some(number) => {
            let allowed = format!("a joint from 1 to {joints} is expected");
            return Err(section.refuse("joint", number.to_string(), &allowed));
        }
    };
    let mut numbers = BTreeMap::new();
    let mut lists = BTreeMap::new();
    for key in section.keys() {
        if key == DRIVEN_BY {
            let count = if name == BACKLASH { 5 } else { 2 };
            let words = SIDES.into_iter().zip([0.0, 1.0, 2.0, 3.0, 4.0]).take(count);
            let words: Vec<(&str, f64)> = words.collect();
            let side = section.word(key, &words)?;
            numbers.extend(side.map(|side| (key.to_owned(), side)));
        } else if key.starts_with(LIST) {
            let list = section.numbers(key)?;
            lists.extend(list.map(|list| (key.to_owned(), list)));
        } else if !OWN_KEYS.contains(&key) {
            let number = section.number(key)?;
            numbers.extend(number.map(|number| (key.to_owned(), number)));
        }
    }
    Ok(DeviceEffect {
        name: name.to_owned(),
        joint,
        intervals: read_intervals(section)?,
        numbers,
        lists,
        confusable_with: (section.texts("confusable_with")?.unwrap_or_default())
            .into_iter()
            .map(str::to_owned)
            .collect(),
        fit: section.truth("fit")?.unwrap_or(false),
        fitted: Vec::new(),
    })
}

/// `ci95 = { width_rad = [low, high] }`; `inf` where an end is open.
fn read_intervals(section: &Section<'_, '_>) -> Result<BTreeMap<String, [Option<f64>; 2]>> {
    let mut intervals = BTreeMap::new();
    let Some(table) = section.table("ci95")? else {
        return Ok(intervals);
    };
    for key in table.keys() {
        let ends = table.ends(key)?;
        intervals.insert(key.to_owned(), ends);
    }
    Ok(intervals)
}

/// Takes a joint's compliance from its table.
fn yield_to(
    section: &Section<'_, '_>,
    effect: &DeviceEffect,
    joints: &[JointType],
    compliance: &mut Vec<JointCompliance>,
) -> Result<()> {
    let Some(joint) = effect.joint else {
        return Err(section.missing("joint", "give the joint that yields, from 1"));
    };
    compliance.resize(joints.len(), JointCompliance::default());
    if compliance[joint] != JointCompliance::default() {
        let found = format!("`{}` once more", effect.label());
        let allowed = "a joint's compliance is written once: delete one, here or in its [[joint]]";
        return Err(section.refuse("name", found, allowed));
    }
    let key = stiffness_key(joints[joint]);
    let stiffness = section.positive(key)?;
    if stiffness.is_none() && !effect.fit {
        return Err(section.missing(key, "give the stiffness, or fit = true"));
    }
    if let Some(other) = effect.numbers.keys().find(|other| *other != key) {
        let allowed = format!("its parameter is `{key}`");
        return Err(section.refuse(other, effect.numbers[other].to_string(), &allowed));
    }
    compliance[joint] = JointCompliance {
        rad_per_nm: stiffness.map_or(0.0, |stiffness| 1.0 / stiffness),
        fit: effect.fit,
    };
    Ok(())
}

/// Key of the stiffness of a joint that yields, in a `joint-compliance` of a device file.
pub fn stiffness_key(joint: JointType) -> &'static str {
    match joint {
        JointType::Revolute => "stiffness_nm_per_rad",
        JointType::Prismatic => "stiffness_n_per_m",
    }
}

/// Writes the effects in place of those of the file; its joint compliances stay.
pub(crate) fn write_effects(document: &mut DocumentMut, effects: &[DeviceEffect]) {
    let mut tables: ArrayOfTables = match document.remove(KEY) {
        Some(Item::ArrayOfTables(old)) => old.into_iter().filter(is_of_compliance).collect(),
        _ => ArrayOfTables::new(),
    };
    tables.extend(effects.iter().map(effect_table));
    if !tables.is_empty() {
        document.insert(KEY, Item::ArrayOfTables(tables));
    }
}

/// Whether a name is that of a joint's compliance.
fn is_compliance(name: &str) -> bool {
    [COMPLIANCE, LINK_COMPLIANCE].contains(&name)
}

/// Whether a table is a joint's compliance.
fn is_of_compliance(table: &Table) -> bool {
    let name = table.get("name").and_then(Item::as_str);
    name.is_some_and(is_compliance)
}

/// Writes a joint's compliance where the file has it as an effect; false where it has not.
pub(crate) fn write_compliance(
    document: &mut DocumentMut,
    joint: usize,
    joint_type: JointType,
    rad_per_nm: f64,
) -> bool {
    let Some(Item::ArrayOfTables(tables)) = document.get_mut(KEY) else {
        return false;
    };
    let number = joint as i64 + 1;
    let is_own = |table: &Table| {
        is_of_compliance(table) && table.get("joint").and_then(Item::as_integer) == Some(number)
    };
    let Some(table) = tables.iter_mut().find(|table| is_own(table)) else {
        return false;
    };
    match rad_per_nm > 0.0 {
        true => table.insert(stiffness_key(joint_type), value(1.0 / rad_per_nm)),
        false => table.remove(stiffness_key(joint_type)),
    };
    true
}

fn effect_table(effect: &DeviceEffect) -> Table {
    let mut table = Table::new();
    table.insert("name", value(&effect.name));
    if let Some(joint) = effect.joint {
        table.insert("joint", value(joint as i64 + 1));
    }
    for (key, number) in &effect.numbers {
        let side = (key == DRIVEN_BY).then(|| SIDES[(*number as usize).min(SIDES.len() - 1)]);
        let written: Value = side.map_or_else(|| Value::from(*number), Value::from);
        table.insert(key, Item::Value(written));
    }
    for (key, list) in &effect.lists {
        let list: Array = list.iter().copied().collect();
        table.insert(key, value(list));
    }
    if !effect.intervals.is_empty() {
        let mut intervals = InlineTable::new();
        for (key, [low, high]) in &effect.intervals {
            let ends = [
                low.unwrap_or(f64::NEG_INFINITY),
                high.unwrap_or(f64::INFINITY),
            ];
            intervals.insert(key, Value::Array(ends.into_iter().collect()));
        }
        table.insert("ci95", Item::Value(Value::InlineTable(intervals)));
    }
    if !effect.confusable_with.is_empty() {
        let names: Array = effect.confusable_with.iter().map(String::as_str).collect();
        table.insert("confusable_with", value(names));
    }
    if effect.fit {
        table.insert("fit", value(true));
    }
    table
}
