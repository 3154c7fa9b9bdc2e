//! Writes a calibrated device back into the text of its file, comments and unknown keys kept.

use haptical_kinematics::Link;
use toml_edit::{Array, ArrayOfTables, DocumentMut, Item, Table, TableLike, Value, value};

use crate::file::reader::Source;
use crate::file::write::surroundings::numbers;
use crate::file::write::whole::{body_items, drive_numbers, number};
use crate::parameter::LINK_KEYS;
use crate::{Device, DeviceFileError, Parameter, TransmissionError};

/// Every key that may hold a number of a transmission error.
const ERROR_KEYS: [&str; 8] = [
    "offset_rad",
    "offset_m",
    "ratio_deviation",
    "output_drum_xy_m",
    "input_drum_xy_m",
    "length_deviations_m",
    "range_rad",
    "chebyshev",
];

impl Device {
    /// The text of the device file `original` with this device's link values, masses, drives, gravity and transmission errors
    /// in place, and the original link values under `[nominal]` (unless it has a `[nominal]`
    /// already, which is kept). Reading the text gives the same numbers, bit by bit.
    ///
    /// # Errors
    /// [`DeviceFileError`] if `original` is not a device file with the same rows and joints, or if
    /// a number of this device is not finite.
    pub fn to_toml(&self, original: &str, file: &str) -> Result<String, DeviceFileError> {
        let before = Self::from_toml(original, file)?.device;
        let shape = |message: String| DeviceFileError::Shape {
            file: file.to_owned(),
            message,
        };
        if before.links.len() != self.links.len() || before.joints.len() != self.joints.len() {
            let message = "the calibrated device has other links or joints than this file";
            return Err(shape(message.to_owned()));
        }
        if let Some(name) = self.not_finite() {
            return Err(shape(format!("the calibrated `{name}` is not finite")));
        }
        let text = original;
        let mut document = Source { file, text }.editable()?;
        for ((row, now), was) in rows(&mut document, "link")
            .into_iter()
            .zip(&self.links)
            .zip(&before.links)
        {
            set_link(row, now, was);
        }
        let bodies = self.bodies.iter().zip(&before.bodies);
        for (row, (now, was)) in rows(&mut document, "link").into_iter().zip(bodies) {
            if let Some(body) = now.filter(|_| now != was) {
                set_items(row, body_items(&body));
            }
        }
        if !before.links.is_empty() && !document.contains_key("nominal") {
            document.insert("nominal", Item::Table(nominal(&before.links)));
        }
        for (row, joint) in rows(&mut document, "joint").into_iter().zip(&self.joints) {
            set_error(row, &joint.transmission_error, joint.unit());
        }
        let joints = self.joints.iter().zip(&before.joints);
        for (row, (now, was)) in rows(&mut document, "joint").into_iter().zip(joints) {
            let pairs = drive_numbers(now).into_iter().zip(drive_numbers(was));
            let changed = pairs.filter(|(now, was)| now != was);
            set_items(row, changed.map(|((key, now), _)| (key, number(now))));
        }
        if let Some(gravity) =
            (self.gravity_mps2).filter(|_| self.gravity_mps2 != before.gravity_mps2)
        {
            let table = document
                .entry("gravity")
                .or_insert_with(|| Item::Table(Table::new()));
            if let Some(table) = table.as_table_like_mut() {
                set(table, "vector_mps2", numbers(&gravity));
            }
        }
        crate::file::write::surroundings::write_changes(&mut document, self, &before);
        Ok(document.to_string())
    }

    /// Name of the first parameter that is not finite.
    fn not_finite(&self) -> Option<String> {
        let mut parameters = self.every_parameter();
        parameters
            .find(|id| !id.value(self).is_finite())
            .map(|id| id.name(self))
    }
}

/// The tables of a list, whether each is written as `[[key]]` or all as `key = [{ .. }, ..]`.
pub(crate) fn rows<'d>(document: &'d mut DocumentMut, key: &str) -> Vec<&'d mut dyn TableLike> {
    match document.get_mut(key) {
        Some(Item::ArrayOfTables(tables)) => tables
            .iter_mut()
            .map(|table| table as &mut dyn TableLike)
            .collect(),
        Some(Item::Value(Value::Array(items))) => items
            .iter_mut()
            .filter_map(Value::as_inline_table_mut)
            .map(|table| table as &mut dyn TableLike)
            .collect(),
        _ => Vec::new(),
    }
}

/// Sets a value; where there was one, the comments around it stay.
pub(crate) fn set(row: &mut dyn TableLike, key: &str, new: impl Into<Value>) {
    let mut new = new.into();
    match row.get_mut(key).and_then(Item::as_value_mut) {
        Some(old) => {
            *new.decor_mut() = old.decor().clone();
            *old = new;
        }
        None => {
            row.insert(key, Item::Value(new));
        }
    }
}

/// Sets values; a key without one is taken away.
fn set_items(
    row: &mut dyn TableLike,
    items: impl IntoIterator<Item = (&'static str, Option<Item>)>,
) {
    for (key, item) in items {
        match item.and_then(|own| own.into_value().ok()) {
            Some(new) => set(row, key, new),
            None => {
                row.remove(key);
            }
        }
    }
}

/// Replaces the numbers that changed and leaves the others as they are written.
fn set_link(row: &mut dyn TableLike, now: &Link, was: &Link) {
    for (number, key) in LINK_KEYS {
        let new = now.get(number);
        if new.to_bits() != was.get(number).to_bits() {
            set(row, key, new);
        }
    }
}

/// A row's numbers; those that few rows have only where they are not 0.
pub(crate) fn link_table(link: &Link) -> Table {
    let mut row = Table::new();
    for (number, key) in LINK_KEYS {
        let is_rare = matches!(number, Parameter::Beta | Parameter::B);
        let number = link.get(number);
        if !is_rare || number.to_bits() != 0 {
            row.insert(key, value(number));
        }
    }
    row
}

pub(crate) fn nominal(links: &[Link]) -> Table {
    let mut nominal_rows = ArrayOfTables::new();
    for link in links {
        nominal_rows.push(link_table(link));
    }
    let mut nominal = Table::new();
    nominal.set_implicit(true);
    nominal.insert("link", Item::ArrayOfTables(nominal_rows));
    nominal
}

/// Writes `[joint.transmission_error]`; a joint without one gets none for an error of zero.
pub(crate) fn set_error(row: &mut dyn TableLike, error: &TransmissionError, unit: &str) {
    const KEY: &str = "transmission_error";
    if !row.contains_key(KEY) {
        if *error == TransmissionError::default() {
            return;
        }
        row.insert(KEY, Item::Table(Table::new()));
    }
    let Some(table) = row.get_mut(KEY).and_then(Item::as_table_like_mut) else {
        return;
    };
    let values = error_values(error, unit);
    for key in ERROR_KEYS {
        if !values.iter().any(|(kept, _)| kept == key) {
            table.remove(key);
        }
    }
    for (key, new) in values {
        set(table, &key, new);
    }
}

fn error_values(error: &TransmissionError, unit: &str) -> Vec<(String, Value)> {
    let list = |key: &str, numbers: &[f64]| {
        let numbers = numbers.iter().copied().collect::<Array>();
        (key.to_owned(), Value::Array(numbers))
    };
    let capstan = match error {
        TransmissionError::Chebyshev {
            range_rad,
            coefficients,
        } => {
            return vec![
                list("range_rad", range_rad),
                list("chebyshev", coefficients),
            ];
        }
        TransmissionError::Parallelogram { capstan, .. } | TransmissionError::Capstan(capstan) => {
            capstan
        }
    };
    let mut values = vec![
        (format!("offset_{unit}"), capstan.offset_rad.into()),
        ("ratio_deviation".to_owned(), capstan.ratio_deviation.into()),
        list("output_drum_xy_m", &capstan.output_drum_xy_m),
        list("input_drum_xy_m", &capstan.input_drum_xy_m),
    ];
    if let TransmissionError::Parallelogram {
        length_deviations_m,
        ..
    } = error
    {
        values.push(list("length_deviations_m", length_deviations_m));
    }
    values
}
