//! The columns of a recording as a log shows them.

use std::fmt::Write as _;

use haptical_model::Recording;

use crate::column::{
    FORCE, ORIENTATION, POSITION, Role, cable_name, joint_name, output_name, torque_name,
};
use crate::error::DataError;
use crate::error::place::Place;
use crate::shape::LogShape;

/// One column with its header.
#[derive(Debug)]
pub(crate) struct WriteColumn<'r> {
    pub(crate) name: String,
    cells: Cells<'r>,
    /// Whether no reading may be missing.
    required: bool,
}

#[derive(Debug)]
enum Cells<'r> {
    Numbers(&'r [f64]),
    Integers(&'r [i64]),
    Texts(&'r [String]),
}

impl WriteColumn<'_> {
    /// Number of rows.
    pub(crate) fn len(&self) -> usize {
        match self.cells {
            Cells::Numbers(numbers) => numbers.len(),
            Cells::Integers(integers) => integers.len(),
            Cells::Texts(texts) => texts.len(),
        }
    }

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
    let mut add = |name: String, cells: Option<Cells<'r>>, required: bool| {
        columns.extend(cells.map(|cells| WriteColumn {
            name,
            cells,
            required,
        }));
    };
    let numbers = |column: Option<&'r Vec<f64>>| column.map(|column| Cells::Numbers(column));
    let texts = |column: Option<&'r Vec<String>>| column.map(|column| Cells::Texts(column));

    add("t_s".to_owned(), numbers(recording.time_s.as_ref()), false);
    add(
        "run".to_owned(),
        recording.run.as_deref().map(Cells::Integers),
        false,
    );
    for (joint, column) in recording.joint.iter().enumerate() {
        add(joint_name(shape, joint), numbers(Some(column)), true);
    }
    for (joint, column) in recording.output.iter().enumerate() {
        add(output_name(shape, joint), numbers(column.as_ref()), false);
    }
    for (cable, column) in recording.cable_m.iter().enumerate() {
        add(cable_name(cable), numbers(column.as_ref()), false);
    }
    for (part, column) in recording.position_m.iter().flatten().enumerate() {
        add(POSITION[part].to_owned(), numbers(Some(column)), false);
    }
    for (part, column) in recording.orientation_wxyz.iter().flatten().enumerate() {
        add(ORIENTATION[part].to_owned(), numbers(Some(column)), false);
    }
    add(
        "contact".to_owned(),
        texts(recording.contact.as_ref()),
        false,
    );
    add("plane".to_owned(), texts(recording.plane.as_ref()), false);
    for (joint, column) in recording.torque_nm.iter().enumerate() {
        add(torque_name(joint), numbers(column.as_ref()), false);
    }
    for (part, column) in recording.force_n.iter().flatten().enumerate() {
        add(FORCE[part].to_owned(), numbers(Some(column)), false);
    }
    add(
        "temp_degc".to_owned(),
        numbers(recording.temperature_degc.as_ref()),
        false,
    );
    for (name, column) in &recording.covariates {
        add(name.clone(), numbers(Some(column)), false);
    }
    Ok(columns)
}

/// Refuses a recording with more joints or cables than the device, or with fewer joints.
fn check_counts(recording: &Recording, shape: &LogShape, file: &str) -> Result<(), DataError> {
    let (joints, cables) = (shape.joints.len(), shape.cable_count);
    let counts = [
        (
            "joint",
            recording.joint.len(),
            joints,
            recording.joint.len() == joints,
        ),
        (
            "output",
            recording.output.len(),
            joints,
            recording.output.len() <= joints,
        ),
        (
            "torque",
            recording.torque_nm.len(),
            joints,
            recording.torque_nm.len() <= joints,
        ),
        (
            "cable",
            recording.cable_m.len(),
            cables,
            recording.cable_m.len() <= cables,
        ),
    ];
    match counts.iter().find(|(_, _, _, fits)| !fits) {
        None => Ok(()),
        Some((what, got, expected, _)) => Err(DataError::InvalidRecording {
            at: Place::file(file),
            what: format!(
                "it has {got} {what} columns and the device {expected}; use the device that it \
                 was recorded with"
            ),
        }),
    }
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
        return Err(DataError::InvalidRecording {
            at,
            what: what.to_owned(),
        });
    }
    Ok(())
}
