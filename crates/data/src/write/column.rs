//! The columns of a recording as a log shows them.

use std::fmt::Write as _;

use haptical_model::Recording;

use crate::column::Role;
use crate::error::place::Place;
use crate::error::{DataError, Fault};
use crate::read::table::Cells;
use crate::shape::LogShape;

/// One column with its header.
#[derive(Debug)]
pub(crate) struct WriteColumn<'r> {
    pub(crate) name: String,
    pub(crate) cells: Cells<'r>,
    /// Whether no reading may be missing.
    required: bool,
}

impl WriteColumn<'_> {
    /// Appends the cell of `row` to `buffer`, or says why it cannot be written.
    pub(crate) fn print(&self, row: usize, buffer: &mut String) -> Result<(), &'static str> {
        match self.cells {
            Cells::Numbers(numbers) => match numbers[row] {
                value if value.is_infinite() => {
                    Err("infinity is no reading; use NaN where there is none")
                }
                value if self.required && value.is_nan() => {
                    Err("a joint's reading is missing; leave the row out")
                }
                value => {
                    print_number(value, buffer);
                    Ok(())
                }
            },
            Cells::Integers(integers) => {
                // Writing to a string cannot fail.
                let _ = write!(buffer, "{}", integers[row]);
                Ok(())
            }
            Cells::Texts(texts) => {
                buffer.push_str(&texts[row]);
                check_text(&texts[row])
            }
        }
    }
}

/// Shortest decimal that reads back to the same number; nothing for `NaN`.
fn print_number(value: f64, buffer: &mut String) {
    let magnitude = value.abs();
    // Writing to a string cannot fail.
    let _ = if magnitude.is_nan() {
        Ok(())
    } else if magnitude == 0.0 || (1e-5..1e16).contains(&magnitude) {
        write!(buffer, "{value}")
    } else {
        // Without an exponent these would be filled up with zeros.
        write!(buffer, "{value:e}")
    };
}

/// Refuses what a reader would trim, or take for an unclosed quotation mark.
fn check_text(text: &str) -> Result<(), &'static str> {
    if text.contains(['\n', '\r']) {
        Err("the text has a line break; remove it")
    } else if text.trim() != text {
        Err("the text has blanks at its ends; remove them")
    } else {
        Ok(())
    }
}

/// The columns that a recording has, in the order of the log format.
pub(crate) fn columns_of<'r>(
    recording: &'r Recording,
    shape: &LogShape,
    file: &str,
) -> Result<Vec<WriteColumn<'r>>, DataError> {
    check_counts(recording, shape, file)?;
    let mut columns = Vec::new();
    let mut add = |role: Role, cells: Option<Cells<'r>>| {
        columns.extend(cells.map(|cells| WriteColumn {
            name: role.name(shape),
            cells,
            required: matches!(role, Role::Joint(_)),
        }));
    };
    let numbers = |column: &'r Vec<f64>| Cells::Numbers(column);
    let texts = |column: &'r Vec<String>| Cells::Texts(column);

    add(Role::Time, recording.time_s.as_ref().map(numbers));
    add(Role::Run, recording.run.as_deref().map(Cells::Integers));
    for (joint, column) in recording.joint.iter().enumerate() {
        add(Role::Joint(joint), Some(numbers(column)));
    }
    for (joint, column) in recording.output.iter().enumerate() {
        add(Role::Output(joint), column.as_ref().map(numbers));
    }
    for (cable, column) in recording.cable_m.iter().enumerate() {
        add(Role::Cable(cable), column.as_ref().map(numbers));
    }
    for (axis, column) in recording.position_m.iter().flatten().enumerate() {
        add(Role::Position(axis), Some(numbers(column)));
    }
    for (part, column) in recording.orientation_wxyz.iter().flatten().enumerate() {
        add(Role::Orientation(part), Some(numbers(column)));
    }
    add(Role::Hand, recording.hand.as_ref().map(texts));
    add(Role::Contact, recording.contact.as_ref().map(texts));
    add(Role::Plane, recording.plane.as_ref().map(texts));
    add(Role::Tool, recording.tool.as_ref().map(texts));
    for (joint, column) in recording.torque_nm.iter().enumerate() {
        add(Role::Torque(joint), column.as_ref().map(numbers));
    }
    for (axis, column) in recording.force_n.iter().flatten().enumerate() {
        add(Role::Force(axis), Some(numbers(column)));
    }
    add(
        Role::Temperature,
        recording.temperature_degc.as_ref().map(numbers),
    );
    columns.extend(
        recording
            .covariates
            .iter()
            .map(|(name, column)| WriteColumn {
                name: name.clone(),
                cells: numbers(column),
                required: false,
            }),
    );
    Ok(columns)
}

/// Refuses a recording with more joints or cables than the device, or with fewer joints.
fn check_counts(recording: &Recording, shape: &LogShape, file: &str) -> Result<(), DataError> {
    let (joints, cables) = (shape.joints.len(), shape.cable_count);
    let counts = [
        ("joint", recording.joint.len(), joints),
        ("output", recording.output.len(), joints),
        ("torque", recording.torque_nm.len(), joints),
        ("cable", recording.cable_m.len(), cables),
    ];
    let is_wrong = |&&(what, got, expected): &&(&str, usize, usize)| {
        got > expected || (what == "joint" && got < expected)
    };
    let Some((what, got, expected)) = counts.iter().find(is_wrong) else {
        return Ok(());
    };
    let what = format!(
        "it has {got} {what} columns and the device {expected}; use the device that it was recorded with"
    );
    Err(Place::file(file).error(Fault::InvalidRecording { what }))
}

/// Refuses covariates whose names would be read as something else.
pub(crate) fn check_covariate_names(
    columns: &[WriteColumn<'_>],
    n_covariates: usize,
    shape: &LogShape,
    file: &str,
) -> Result<(), DataError> {
    let first = columns.len().saturating_sub(n_covariates);
    for (index, WriteColumn { name, .. }) in columns.iter().enumerate().skip(first) {
        let what = if Role::parse(name, shape) != Role::Covariate {
            "a covariate cannot have the name of another column or none; rename it"
        } else if columns[..index].iter().any(|other| other.name == *name) {
            "two covariates have this name; rename one"
        } else if let Err(what) = check_text(name) {
            what
        } else {
            continue;
        };
        let at = Place::cell(file, 1, index + 1, name);
        return Err(at.error(Fault::InvalidRecording {
            what: what.to_owned(),
        }));
    }
    Ok(())
}
