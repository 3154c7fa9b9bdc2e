//! Writes a device file of its own for a device that has none, such as one from a URDF.

use haptical_kinematics::Convention;
use toml_edit::{Array, ArrayOfTables, DocumentMut, Item, Table, value};

use crate::device::cable::Cable;
use crate::device::joint::{Joint, JointType, TransmissionKind};
use crate::device::rows::{Drive, Origin};
use crate::device::{Body, Tracker};
use crate::file::write::changes::{link_table, nominal, set_error};
use crate::parameter::unknown::DEVIATION_KEYS;
use crate::{Device, DeviceFileError};

impl Device {
    /// A device file (TOML) that holds everything this device does. Reading it gives the same device, bit
    /// by bit; [`Device::to_toml`] keeps the comments of a file that exists.
    ///
    /// ```
    /// use haptical_model::Device;
    /// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
    /// let device = Device::load(path.as_ref())?.device;
    /// let again = Device::from_toml(&device.to_new_toml()?, "again.toml")?.device;
    /// assert_eq!(again, device);
    /// # Ok::<(), haptical_model::DeviceFileError>(())
    /// ```
    ///
    /// # Errors
    /// [`DeviceFileError`] for a device that no file can describe: a number that is not finite, or counts
    /// that do not fit each other.
    pub fn to_new_toml(&self) -> Result<String, DeviceFileError> {
        let text = self.document().to_string();
        let file = "the device";
        // what is written must be readable: whatever the reader refuses is refused here
        let again = Self::from_toml(&text, file)?.device;
        let written = Self {
            surroundings: self.surroundings.settled(),
            ..self.clone()
        };
        if again == written {
            return Ok(text);
        }
        Err(DeviceFileError::Shape {
            file: file.to_owned(),
            message: "its lists of rows, joints and masses do not fit each other".to_owned(),
        })
    }

    fn document(&self) -> DocumentMut {
        let mut document = DocumentMut::new();
        let mut head = Table::new();
        head.insert("name", value(self.name.as_str()));
        head.insert("dof", value(self.joints.len() as i64));
        if self.convention == Convention::Modified {
            head.insert("convention", value("modified"));
        }
        if let Some(Some(handle)) = self.origins.get(self.links.len()) {
            insert_origin(&mut head, "handle_xyz_m", "handle_wxyz", handle);
        }
        document.insert("device", Item::Table(head));
        let rows = (0..self.links.len()).map(|row| self.row_table(row));
        insert_tables(&mut document, "link", rows.collect());
        let joints = self.joints.iter().map(joint_table).collect();
        insert_tables(&mut document, "joint", joints);
        let mut cables = self.cables.iter().map(cable_table);
        if let Some(first) = cables.next() {
            document.insert("cable_encoder", Item::Table(first));
        }
        insert_tables(&mut document, "cable", cables.collect());
        if let Some(tracker) = &self.tracker {
            document.insert("tracker", Item::Table(tracker_table(tracker)));
        }
        let pairs = self.contact_pairs.iter().map(|pair| {
            let mut table = Table::new();
            table.insert("a", value(pair.a.as_str()));
            table.insert("b", value(pair.b.as_str()));
            table.insert("distance_m", value(pair.distance_m));
            table.insert("sd_m", value(pair.sd_m));
            table
        });
        insert_tables(&mut document, "contact_pair", pairs.collect());
        crate::file::write::surroundings::write_all(&mut document, self);
        if let Some(gravity) = &self.gravity_mps2 {
            let mut table = Table::new();
            table.insert("vector_mps2", list(gravity));
            document.insert("gravity", Item::Table(table));
        }
        if let Some(links) = &self.nominal_links {
            document.insert("nominal", Item::Table(nominal(links)));
        }
        document
    }

    fn row_table(&self, row: usize) -> Table {
        let mut table = self.links.get(row).map(link_table).unwrap_or_default();
        if let Some(Some(origin)) = self.origins.get(row) {
            insert_origin(&mut table, "origin_xyz_m", "origin_wxyz", origin);
        }
        for (number, key) in DEVIATION_KEYS {
            if let Some(size) = self.deviation(row, number) {
                table.insert(key, value(size));
            }
        }
        if let Some(drive) = row.checked_sub(1).and_then(|index| self.drives.get(index)) {
            insert_drive(&mut table, drive);
        }
        if let Some(Some(Body {
            mass_kg,
            centre_of_mass_m,
        })) = self.bodies.get(row)
        {
            table.insert("mass_kg", value(*mass_kg));
            table.insert("centre_of_mass_m", list(centre_of_mass_m));
        }
        table
    }
}

pub(crate) fn list(numbers: &[f64]) -> Item {
    value(numbers.iter().copied().collect::<Array>())
}

pub(crate) fn insert_tables(document: &mut DocumentMut, key: &str, tables: Vec<Table>) {
    if !tables.is_empty() {
        let tables: ArrayOfTables = tables.into_iter().collect();
        document.insert(key, Item::ArrayOfTables(tables));
    }
}

pub(crate) fn insert_origin(table: &mut Table, place: &str, turn: &str, origin: &Origin) {
    table.insert(place, list(&origin.position_m));
    table.insert(turn, list(&origin.orientation_wxyz));
}

fn insert_drive(table: &mut Table, drive: &Drive) {
    table.insert("driven_by", value(drive.joint as i64 + 1));
    table.insert("driven_type", value(type_name(drive.motion)));
    table.insert("driven_multiplier", value(drive.multiplier));
    let key = match drive.motion {
        JointType::Revolute => "driven_offset_rad",
        JointType::Prismatic => "driven_offset_m",
    };
    table.insert(key, value(drive.offset));
}

fn type_name(joint_type: JointType) -> &'static str {
    match joint_type {
        JointType::Revolute => "revolute",
        JointType::Prismatic => "prismatic",
    }
}

fn insert_numbers(table: &mut Table, numbers: &[(&str, Option<f64>)]) {
    for (key, number) in numbers {
        if let Some(number) = number {
            table.insert(key, value(*number));
        }
    }
}

fn joint_table(joint: &Joint) -> Table {
    let mut table = Table::new();
    table.insert("name", value(joint.name.as_str()));
    table.insert("type", value(type_name(joint.joint_type)));
    let keys = match joint.joint_type {
        JointType::Revolute => ["home_rad", "lower_rad", "upper_rad"],
        JointType::Prismatic => ["home_m", "lower_m", "upper_m"],
    };
    let limits = [joint.home_rad, joint.lower_rad, joint.upper_rad];
    for (key, limit) in keys.into_iter().zip(limits) {
        // a joint without limits has none in its file
        if limit.is_finite() {
            table.insert(key, value(limit));
        }
    }
    let transmission = match joint.transmission {
        TransmissionKind::Capstan => "capstan",
        TransmissionKind::Parallelogram => "parallelogram",
        TransmissionKind::Direct => "direct",
    };
    table.insert("transmission", value(transmission));
    insert_numbers(
        &mut table,
        &[
            ("transmission_ratio", Some(joint.transmission_ratio)),
            ("drum_distance_m", joint.drum_distance_m),
            ("input_drum_denominator_m", joint.input_drum_denominator_m),
            ("encoder_counts_per_rev", joint.encoder_counts_per_rev),
            (
                "external_encoder_counts_per_rev",
                joint.external_encoder_counts_per_rev,
            ),
            ("external_encoder_sd_rad", joint.external_encoder_sd_rad),
            ("torque_scale_sd", Some(joint.torque_scale_sd)),
            ("sampling_sd_rad", joint.sampling_sd_rad),
        ],
    );
    if let Some(lengths_m) = &joint.parallelogram_lengths_m {
        table.insert("parallelogram_lengths_m", list(lengths_m));
    }
    set_error(&mut table, &joint.transmission_error, joint.unit());
    table
}

fn cable_table(cable: &Cable) -> Table {
    let mut table = Table::new();
    table.insert("anchor_m", list(&cable.anchor_m));
    insert_numbers(
        &mut table,
        &[
            ("drum_radius_m", cable.drum_radius_m),
            ("counts_per_rev", cable.counts_per_rev),
            ("distance_sd_m", cable.distance_sd_m),
        ],
    );
    if let Some(axis) = &cable.exit_axis {
        table.insert("exit_axis", list(axis));
    }
    let plain = Cable::default();
    for (key, number, usual) in [
        ("zero_m", cable.zero_m, plain.zero_m),
        ("scale", cable.scale, plain.scale),
        ("exit_radius_m", cable.exit_radius_m, plain.exit_radius_m),
    ] {
        if number.to_bits() != usual.to_bits() {
            table.insert(key, value(number));
        }
    }
    let fit = cable.fit;
    let words: Array = [
        (fit.anchor, "anchor"),
        (fit.zero, "zero"),
        (fit.scale, "scale"),
        (fit.exit_radius, "exit_radius"),
    ]
    .into_iter()
    .filter_map(|(is_fitted, word)| is_fitted.then_some(word))
    .collect();
    if !words.is_empty() {
        table.insert("fit", value(words));
    }
    table
}

fn tracker_table(tracker: &Tracker) -> Table {
    let word = |known: bool| value(if known { "known" } else { "unknown" });
    let mut table = Table::new();
    table.insert("base", word(tracker.base_known));
    table.insert("tool", word(tracker.tool_known));
    insert_numbers(
        &mut table,
        &[
            ("position_sd_m", tracker.position_sd_m),
            ("rotation_sd_rad", tracker.rotation_sd_rad),
        ],
    );
    table
}
