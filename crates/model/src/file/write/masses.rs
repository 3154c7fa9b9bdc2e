//! Writes masses, armatures and gravity that changed into a device file's text.

use toml_edit::{DocumentMut, Item, Table};

use crate::file::write::changes::{rows, set};
use crate::file::write::surroundings::numbers;
use crate::{Body, Device, JointType};

/// Key of a joint's armature.
fn armature_key(joint_type: JointType) -> &'static str {
    match joint_type {
        JointType::Revolute => "armature_kgm2",
        JointType::Prismatic => "armature_kg",
    }
}

/// Replaces the numbers that changed and leaves the others as they are written.
pub(crate) fn write_masses(document: &mut DocumentMut, now: &Device, before: &Device) {
    let body =
        |device: &Device, row: usize| -> Option<Body> { device.bodies.get(row).copied().flatten() };
    for (index, row) in rows(document, "link").into_iter().enumerate() {
        let (new, old) = (body(now, index), body(before, index));
        let Some(new) = new.filter(|_| new != old) else {
            continue;
        };
        set(row, "mass_kg", new.mass_kg);
        set(row, "centre_of_mass_m", numbers(&new.centre_of_mass_m));
        if let Some(inertia) = new.inertia_kgm2 {
            set(row, "inertia_kgm2", numbers(&inertia));
        }
    }
    let joints = now.joints.iter().zip(&before.joints);
    for (row, (new, old)) in rows(document, "joint").into_iter().zip(joints) {
        let Some(armature) = new
            .armature_kgm2
            .filter(|_| new.armature_kgm2 != old.armature_kgm2)
        else {
            continue;
        };
        // a slide's may be written under either key, and its own comes first
        let keys = [armature_key(new.joint_type), "armature_kgm2"];
        let stated = keys.into_iter().find(|key| row.contains_key(key));
        set(row, stated.unwrap_or(keys[0]), armature);
    }
    let Some(gravity) = now
        .gravity_mps2
        .filter(|_| now.gravity_mps2 != before.gravity_mps2)
    else {
        return;
    };
    let table = document
        .entry("gravity")
        .or_insert_with(|| Item::Table(Table::new()));
    if let Some(table) = table.as_table_like_mut() {
        set(table, "vector_mps2", numbers(&gravity));
    }
}
