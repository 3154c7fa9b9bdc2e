//! Writes a device file of its own for a device that has none, such as one from a URDF.

use haptical_kinematics::Convention;
use toml_edit::{Array, ArrayOfTables, DocumentMut, Item, Table, value};

use crate::device::Tracker;
use crate::device::cable::Cable;
use crate::device::joint::Joint;
use crate::device::rows::{Drive, Origin};
use crate::file::joint::is_number;
use crate::file::sensors::fit_words;
use crate::file::write::changes::{link_table, nominal, set_error};
use crate::file::{BASES, CONVENTIONS, JOINT_TYPES, PLACES, TRANSMISSIONS, word_for};
use crate::parameter::unknown::DEVIATION_KEYS;
use crate::{Body, Device, DeviceEffect, DeviceFileError, DriveNumber, Hand};

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
        let joints = self.joints.iter().enumerate().map(|(index, joint)| Joint {
            has_numeric_name: is_number(&joint.name) && writes_name(index, joint),
            ..joint.clone()
        });
        let written = Self {
            joints: joints.collect(),
            surroundings: self.surroundings.settled(),
            effects: self.effects.iter().map(DeviceEffect::as_written).collect(),
            ..self.clone()
        };
        if again == written {
            return Ok(text);
        }
        Err(DeviceFileError::Shape {
            file: file.to_owned(),
            message: "its lists of rows, joints, hands and masses do not fit each other".to_owned(),
        })
    }

    fn document(&self) -> DocumentMut {
        let mut document = DocumentMut::new();
        let mut head = table([
            ("name", text(&self.name)),
            ("dof", Some(value(self.joints.len() as i64))),
        ]);
        if self.convention != Convention::Standard {
            let convention = word_for(CONVENTIONS, &self.convention);
            head.insert("convention", value(convention));
        }
        if let Some(Some(handle)) = self.origins.get(self.links.len()) {
            insert_origin(&mut head, "handle_xyz_m", "handle_wxyz", handle);
        }
        document.insert("device", Item::Table(head));
        let rows = (0..self.links.len()).map(|row| self.row_table(row));
        insert_tables(&mut document, "link", rows.collect());
        insert_tables(
            &mut document,
            "hand",
            self.hands.iter().map(hand_table).collect(),
        );
        let joints = self.joints.iter().enumerate();
        let joints = joints.map(|(index, joint)| joint_table(index, joint));
        insert_tables(&mut document, "joint", joints.collect());
        let mut cables = self.cables.iter().map(cable_table);
        if let Some(first) = cables.next() {
            document.insert("cable_encoder", Item::Table(first));
        }
        insert_tables(&mut document, "cable", cables.collect());
        if let Some(tracker) = &self.tracker {
            document.insert("tracker", Item::Table(tracker_table(tracker)));
        }
        let pairs = self.contact_pairs.iter().map(|pair| {
            table([
                ("a", text(&pair.a)),
                ("b", text(&pair.b)),
                ("distance_m", number(pair.distance_m)),
                ("sd_m", number(pair.sd_m)),
            ])
        });
        insert_tables(&mut document, "contact_pair", pairs.collect());
        crate::file::write::surroundings::write_all(&mut document, self);
        if let Some(gravity) = &self.gravity_mps2 {
            let gravity = table([("vector_mps2", list(gravity))]);
            document.insert("gravity", Item::Table(gravity));
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
        let parent = self.parent(row);
        if let Some(parent) = parent.filter(|parent| parent + 1 != row) {
            table.insert("parent", value(parent as i64));
        }
        for (number, key) in DEVIATION_KEYS {
            if let Some(size) = self.deviation(row, number) {
                table.insert(key, value(size));
            }
        }
        if let Some(drive) = row.checked_sub(1).and_then(|index| self.drives.get(index)) {
            insert_drive(&mut table, drive);
        }
        if let Some(Some(body)) = self.bodies.get(row) {
            for (key, item) in body_items(body) {
                insert(&mut table, key, item);
            }
        }
        table
    }
}

/// What a row carries, by its keys.
pub(crate) fn body_items(body: &Body) -> [(&'static str, Option<Item>); 3] {
    [
        ("mass_kg", number(body.mass_kg)),
        ("centre_of_mass_m", list(&body.centre_of_mass_m)),
        (
            "inertia_kgm2",
            body.inertia_kgm2.as_ref().and_then(|own| list(own)),
        ),
    ]
}

/// A table of what there is.
pub(crate) fn table<const N: usize>(entries: [(&str, Option<Item>); N]) -> Table {
    let mut table = Table::new();
    for (key, item) in entries {
        insert(&mut table, key, item);
    }
    table
}

fn insert(table: &mut Table, key: &str, item: Option<Item>) {
    if let Some(item) = item {
        table.insert(key, item);
    }
}

pub(crate) fn text(text: &str) -> Option<Item> {
    Some(value(text))
}

pub(crate) fn number(number: impl Into<Option<f64>>) -> Option<Item> {
    number.into().map(value)
}

pub(crate) fn list(numbers: &[f64]) -> Option<Item> {
    Some(value(numbers.iter().copied().collect::<Array>()))
}

pub(crate) fn insert_tables(document: &mut DocumentMut, key: &str, tables: Vec<Table>) {
    if !tables.is_empty() {
        let tables: ArrayOfTables = tables.into_iter().collect();
        document.insert(key, Item::ArrayOfTables(tables));
    }
}

fn insert_origin(table: &mut Table, place: &str, turn: &str, origin: &Origin) {
    insert(table, place, list(&origin.position_m));
    insert(table, turn, list(&origin.orientation_wxyz));
}

fn insert_drive(table: &mut Table, drive: &Drive) {
    table.insert("driven_by", value(drive.joint as i64 + 1));
    table.insert("driven_type", value(word_for(JOINT_TYPES, &drive.motion)));
    table.insert("driven_multiplier", value(drive.multiplier));
    let key = format!("driven_offset_{}", drive.motion.unit());
    table.insert(&key, value(drive.offset));
}

fn hand_table(hand: &Hand) -> Table {
    let mut hand_table = table([("name", text(&hand.name))]);
    hand_table.insert("row", value(hand.row as i64));
    if let Some(handle) = &hand.handle {
        insert_origin(&mut hand_table, "handle_xyz_m", "handle_wxyz", handle);
    }
    hand_table
}

/// Whether a joint's name is more than the number that it has without one.
fn writes_name(index: usize, joint: &Joint) -> bool {
    joint.has_own_name() || joint.name != (index + 1).to_string()
}

fn joint_table(index: usize, joint: &Joint) -> Table {
    let mut joint_table = table([
        (
            "name",
            text(&joint.name).filter(|_| writes_name(index, joint)),
        ),
        ("type", text(word_for(JOINT_TYPES, &joint.joint_type))),
    ]);
    let limits = [
        ("home", joint.home_rad),
        ("lower", joint.lower_rad),
        ("upper", joint.upper_rad),
    ];
    for (key, limit) in limits {
        // a joint without limits has none in its file
        let limit = Some(limit).filter(|limit| limit.is_finite());
        let key = format!("{key}_{}", joint.unit());
        insert(&mut joint_table, &key, number(limit));
    }
    let kind = word_for(TRANSMISSIONS, &joint.transmission);
    joint_table.insert("transmission", value(kind));
    let output_counts = joint.external_encoder_counts_per_rev;
    for (key, of_joint) in [
        ("transmission_ratio", Some(joint.transmission_ratio)),
        ("drum_distance_m", joint.drum_distance_m),
        ("input_drum_denominator_m", joint.input_drum_denominator_m),
        ("encoder_counts_per_rev", joint.encoder_counts_per_rev),
        ("external_encoder_counts_per_rev", output_counts),
        ("external_encoder_sd_rad", joint.external_encoder_sd_rad),
        ("torque_scale_sd", Some(joint.torque_scale_sd)),
        ("sampling_sd_rad", joint.sampling_sd_rad),
    ] {
        insert(&mut joint_table, key, number(of_joint));
    }
    for (key, of_drive) in drive_numbers(joint) {
        insert(&mut joint_table, key, number(of_drive));
    }
    if let Some(lengths_m) = &joint.parallelogram_lengths_m {
        insert(&mut joint_table, "parallelogram_lengths_m", list(lengths_m));
    }
    set_error(&mut joint_table, &joint.transmission_error, joint.unit());
    joint_table
}

/// What is known of a joint's drive, by the keys of its unit.
pub(crate) fn drive_numbers(joint: &Joint) -> [(&'static str, Option<f64>); 4] {
    DriveNumber::ALL.map(|own| (own.key(joint.joint_type), own.stated(joint)))
}

fn cable_table(cable: &Cable) -> Table {
    let unusual = |number: f64, usual: f64| (number.to_bits() != usual.to_bits()).then_some(number);
    let plain = Cable::default();
    let (exit_axis, radius_m) = (cable.exit_axis.as_ref(), cable.exit_radius_m);
    let words: Array = fit_words(cable.fit)
        .into_iter()
        .filter_map(|(word, is_fitted)| is_fitted.then_some(word))
        .collect();
    table([
        ("anchor_m", list(&cable.anchor_m)),
        ("drum_radius_m", number(cable.drum_radius_m)),
        ("counts_per_rev", number(cable.counts_per_rev)),
        ("distance_sd_m", number(cable.distance_sd_m)),
        ("scale_sd", number(cable.scale_sd)),
        ("exit_axis", exit_axis.and_then(|axis| list(axis))),
        ("zero_m", number(unusual(cable.zero_m, plain.zero_m))),
        ("scale", number(unusual(cable.scale, plain.scale))),
        (
            "exit_radius_m",
            number(unusual(radius_m, plain.exit_radius_m)),
        ),
        ("fit", (!words.is_empty()).then(|| value(words))),
    ])
}

fn tracker_table(tracker: &Tracker) -> Table {
    table([
        (
            "base",
            text(word_for(BASES, &(tracker.base_known, tracker.base_per_run))),
        ),
        ("tool", text(word_for(PLACES, &tracker.tool_known))),
        ("position_sd_m", number(tracker.position_sd_m)),
        ("rotation_sd_rad", number(tracker.rotation_sd_rad)),
        ("scale_sd", number(tracker.scale_sd)),
    ])
}
