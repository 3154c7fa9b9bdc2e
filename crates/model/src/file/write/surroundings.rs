//! Writes what a device is measured against into its file.

use toml_edit::{Array, ArrayOfTables, DocumentMut, Item, Table, TableLike, Value, value};

use crate::Device;
use crate::device::cable::Cable;
use crate::device::mount::{RunBase, Tool};
use crate::device::surroundings::{ContactPoint, Placement, Surroundings, TouchedPlane};
use crate::file::effect::{write_compliance, write_effects};
use crate::file::sensors::{BASE_OF_RUN, PLACE_KEYS, PLACEMENT_KEYS};
use crate::file::write::changes::{rows, set};
use crate::file::write::whole::{insert_tables, list, number, table, text};
use crate::parameter::compliance_key;

/// Writes what a calibration may have changed: places, points, planes, cables, compliances.
pub(crate) fn write_changes(document: &mut DocumentMut, now: &Device, before: &Device) {
    let (new, old) = (now.surroundings.settled(), before.surroundings.settled());
    write_places(document, &new, &old);
    if new.tools != old.tools {
        let tables: ArrayOfTables = new.tools.iter().map(tool_table).collect();
        document.insert("tool", Item::ArrayOfTables(tables));
    }
    if new.contacts != old.contacts {
        let tables: ArrayOfTables = new.contacts.iter().map(contact_table).collect();
        document.insert("contact_point", Item::ArrayOfTables(tables));
    }
    if new.planes != old.planes {
        let tables: ArrayOfTables = new.planes.iter().map(plane_table).collect();
        document.insert("touched_plane", Item::ArrayOfTables(tables));
    }
    let plain = Cable::default();
    let mut cables = now.cables.iter().enumerate().map(|(index, cable)| {
        let was = before.cables.get(index).unwrap_or(&plain);
        (cable, was)
    });
    if let (Some((cable, was)), Some(table)) = (
        cables.next(),
        document
            .get_mut("cable_encoder")
            .and_then(Item::as_table_like_mut),
    ) {
        set_cable(table, cable, was);
    }
    for (table, (cable, was)) in rows(document, "cable").into_iter().zip(cables) {
        set_cable(table, cable, was);
    }
    set_compliances(document, now, before);
    if now.effects != before.effects {
        write_effects(document, &now.effects);
    }
}

/// Writes everything into a file that has none of it.
pub(crate) fn write_all(document: &mut DocumentMut, device: &Device) {
    let surroundings = device.surroundings.settled();
    write_places(document, &surroundings, &Surroundings::default());
    for (section, key, sd) in [
        ("contact", "sd_m", surroundings.contact_sd_m),
        ("plane", "sd_m", surroundings.plane_sd_m),
        ("fixture", "sd_rad", surroundings.fixture_sd_rad),
    ] {
        if sd.is_some() {
            document.insert(section, Item::Table(table([(key, number(sd))])));
        }
    }
    let tools = surroundings.tools.iter().map(tool_table).collect();
    insert_tables(document, "tool", tools);
    let contacts = surroundings.contacts.iter().map(contact_table).collect();
    insert_tables(document, "contact_point", contacts);
    let planes = surroundings.planes.iter().map(plane_table).collect();
    insert_tables(document, "touched_plane", planes);
    let pairs = surroundings.plane_pairs.iter().map(|pair| {
        table([
            ("a", text(&pair.a)),
            ("b", text(&pair.b)),
            ("angle_rad", number(pair.angle_rad)),
            ("sd_rad", number(pair.sd_rad)),
        ])
    });
    insert_tables(document, "plane_pair", pairs.collect());
    let rigid = Device {
        surroundings: Surroundings::default(),
        ..device.clone()
    };
    set_compliances(document, device, &rigid);
    write_effects(document, &device.effects);
    for (table, compliance) in rows(document, "joint")
        .into_iter()
        .zip(&surroundings.compliance)
    {
        if compliance.fit {
            table.insert("fit", value(Array::from_iter(["compliance"])));
        }
    }
}

fn write_places(document: &mut DocumentMut, new: &Surroundings, old: &Surroundings) {
    let places = [
        (new.tracker_base, old.tracker_base),
        (new.tracker_tool, old.tracker_tool),
    ];
    for ((now, was), [place, turn]) in places.into_iter().zip(PLACEMENT_KEYS) {
        let Some(Placement { start, .. }) = now.filter(|_| now != was) else {
            continue;
        };
        if let Some(table) = tracker_of(document) {
            set(table, place, numbers(&start.position_m));
            set(table, turn, numbers(&start.orientation_wxyz));
        }
    }
    if new.run_bases != old.run_bases
        && let Some(table) = tracker_of(document)
    {
        let tables: ArrayOfTables = new.run_bases.iter().map(run_base_table).collect();
        table.insert(BASE_OF_RUN, Item::ArrayOfTables(tables));
    }
}

/// The table `[tracker]`, made where there is none.
fn tracker_of(document: &mut DocumentMut) -> Option<&mut dyn TableLike> {
    let table = document
        .entry("tracker")
        .or_insert_with(|| Item::Table(Table::new()));
    table.as_table_like_mut()
}

fn run_base_table(base: &RunBase) -> Table {
    let start = &base.placement.start;
    table([
        ("run", Some(value(base.run))),
        (PLACE_KEYS[0], list(&start.position_m)),
        (PLACE_KEYS[1], list(&start.orientation_wxyz)),
    ])
}

fn tool_table(tool: &Tool) -> Table {
    let start = tool.placement.map(|placement| placement.start);
    let turn = start.filter(|_| tool.has_turn);
    let line = tool.from_line.and_then(|line| i64::try_from(line).ok());
    table([
        ("id", text(&tool.id)),
        (
            PLACE_KEYS[0],
            start.and_then(|start| list(&start.position_m)),
        ),
        (
            PLACE_KEYS[1],
            turn.and_then(|turn| list(&turn.orientation_wxyz)),
        ),
        ("from_line", line.map(value)),
    ])
}

pub(crate) fn numbers(values: &[f64]) -> Value {
    Value::Array(values.iter().copied().collect())
}

fn contact_table(point: &ContactPoint) -> Table {
    table([
        ("id", text(&point.id)),
        ("position_m", list(&point.position_m)),
    ])
}

fn plane_table(plane: &TouchedPlane) -> Table {
    table([
        ("id", text(&plane.id)),
        ("normal", list(&plane.normal)),
        ("offset_m", number(plane.offset_m)),
    ])
}

fn set_cable(table: &mut dyn TableLike, now: &Cable, was: &Cable) {
    if now.anchor_m != was.anchor_m {
        set(table, "anchor_m", numbers(&now.anchor_m));
    }
    if let Some(axis) = now.exit_axis.filter(|_| now.exit_axis != was.exit_axis) {
        set(table, "exit_axis", numbers(&axis));
    }
    for (key, new, old) in [
        ("zero_m", now.zero_m, was.zero_m),
        ("scale", now.scale, was.scale),
        ("exit_radius_m", now.exit_radius_m, was.exit_radius_m),
    ] {
        if new.to_bits() != old.to_bits() {
            set(table, key, new);
        }
    }
}

fn set_compliances(document: &mut DocumentMut, now: &Device, before: &Device) {
    for (index, joint) in now.joints.iter().enumerate() {
        let (new, old) = (
            now.compliance_rad_per_nm(index),
            before.compliance_rad_per_nm(index),
        );
        if new.to_bits() == old.to_bits()
            || write_compliance(document, index, joint.joint_type, new)
        {
            continue;
        }
        if let Some(table) = rows(document, "joint").into_iter().nth(index) {
            set(table, compliance_key(joint.joint_type), new);
        }
    }
}
