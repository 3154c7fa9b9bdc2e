//! Writes a calibrated device back into the text of its file, comments and unknown keys kept.

use haptical_kinematics::Link;
use toml_edit::{Array, ArrayOfTables, DocumentMut, Item, Table, value};

use crate::{Device, DeviceFileError, TransmissionError};

impl Device {
    /// The text of the device file `original` with this device's link values and transmission errors
    /// in place, and the original link values under `[nominal]` (unless it has a `[nominal]`
    /// already, which is kept).
    ///
    /// # Errors
    /// [`DeviceFileError`] if `original` is not a device file with the same rows and joints.
    pub fn to_toml(&self, original: &str, file: &str) -> Result<String, DeviceFileError> {
        let before = Self::from_toml(original, file)?.device;
        if before.links.len() != self.links.len() || before.joints.len() != self.joints.len() {
            return Err(DeviceFileError::Shape {
                file: file.to_owned(),
                message: "the calibrated device has other links or joints than this file"
                    .to_owned(),
            });
        }
        let mut document: DocumentMut =
            original
                .parse()
                .map_err(|error: toml_edit::TomlError| DeviceFileError::Syntax {
                    file: file.to_owned(),
                    line: 1,
                    column: 1,
                    message: error.message().to_owned(),
                })?;
        if let Some(rows) = document
            .get_mut("link")
            .and_then(Item::as_array_of_tables_mut)
        {
            for ((row, now), was) in rows.iter_mut().zip(&self.links).zip(&before.links) {
                set_row(row, now, was);
            }
            if !document.contains_key("nominal") {
                let mut nominal_rows = ArrayOfTables::new();
                for link in &before.links {
                    nominal_rows.push(row_table(link));
                }
                let mut nominal = Table::new();
                nominal.set_implicit(true);
                nominal.insert("link", Item::ArrayOfTables(nominal_rows));
                document.insert("nominal", Item::Table(nominal));
            }
        }
        if let Some(rows) = document
            .get_mut("joint")
            .and_then(Item::as_array_of_tables_mut)
        {
            for (row, joint) in rows.iter_mut().zip(&self.joints) {
                let zero = joint.transmission_error == TransmissionError::default();
                if zero && !row.contains_key("transmission_error") {
                    continue;
                }
                let table = error_table(&joint.transmission_error, joint.unit());
                row.insert("transmission_error", Item::Table(table));
            }
        }
        Ok(document.to_string())
    }
}

/// Replaces the numbers that changed and leaves the others as they are written.
fn set_row(row: &mut Table, now: &Link, was: &Link) {
    for (key, new, old) in [
        ("a_m", now.a_m, was.a_m),
        ("alpha_rad", now.alpha_rad, was.alpha_rad),
        ("d_m", now.d_m, was.d_m),
        ("theta_offset_rad", now.theta_rad, was.theta_rad),
        ("beta_rad", now.beta_rad, was.beta_rad),
    ] {
        if new.to_bits() != old.to_bits() {
            row.insert(key, value(new));
        }
    }
}

fn row_table(link: &Link) -> Table {
    let mut table = Table::new();
    table.insert("a_m", value(link.a_m));
    table.insert("alpha_rad", value(link.alpha_rad));
    table.insert("d_m", value(link.d_m));
    table.insert("theta_offset_rad", value(link.theta_rad));
    if link.beta_rad != 0.0 {
        table.insert("beta_rad", value(link.beta_rad));
    }
    table
}

fn error_table(error: &TransmissionError, unit: &str) -> Table {
    let list = |numbers: &[f64]| value(numbers.iter().copied().collect::<Array>());
    let mut table = Table::new();
    let capstan = match error {
        TransmissionError::Chebyshev {
            range_rad,
            coefficients,
        } => {
            table.insert("range_rad", list(range_rad));
            table.insert("chebyshev", list(coefficients));
            return table;
        }
        TransmissionError::Parallelogram {
            capstan,
            length_deviations_m,
        } => {
            table.insert("length_deviations_m", list(length_deviations_m));
            capstan
        }
        TransmissionError::Capstan(capstan) => capstan,
    };
    table.insert(&format!("offset_{unit}"), value(capstan.offset_rad));
    table.insert("ratio_deviation", value(capstan.ratio_deviation));
    table.insert("output_drum_xy_m", list(&capstan.output_drum_xy_m));
    table.insert("input_drum_xy_m", list(&capstan.input_drum_xy_m));
    table
}
