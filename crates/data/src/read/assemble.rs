//! Columns of cells to the fields of a recording.

use haptical_model::Recording;

use crate::column::{FORCE, ORIENTATION, POSITION, Role};
use crate::error::place::Place;
use crate::error::{DataError, Fault};
use crate::read::LoadedLog;
use crate::read::cell;
use crate::read::groups::Groups;
use crate::shape::LogShape;
use crate::size::{LARGEST_READING, LONGEST_ID_BYTES, NUMBER_BYTES, TEXT_BYTES};

/// One column while its cells are read.
#[derive(Debug)]
pub(crate) struct Column {
    pub(crate) name: String,
    /// Position in the header, counted from 1.
    pub(crate) number: usize,
    pub(crate) role: Role,
    pub(super) values: Values,
    /// First cell of a covariate that is text, or not finite.
    text: Option<(u64, String)>,
    not_finite: Option<(u64, String)>,
}

#[derive(Debug)]
pub(super) enum Values {
    Numbers(Vec<f64>),
    Integers(Vec<i64>),
    Texts(Vec<String>),
}

impl Column {
    /// An empty column.
    pub(crate) fn new(name: &str, number: usize, role: Role) -> Self {
        let values = match role {
            Role::Run => Values::Integers(Vec::new()),
            role if role.is_text() => Values::Texts(Vec::new()),
            _ => Values::Numbers(Vec::new()),
        };
        Self {
            name: name.to_owned(),
            number,
            role,
            values,
            text: None,
            not_finite: None,
        }
    }

    /// Adds a trimmed cell; returns the memory that it takes \[bytes\].
    pub(crate) fn push(&mut self, cell: &str, line: u64, file: &str) -> Result<u64, DataError> {
        let fault = match &mut self.values {
            Values::Texts(_) if cell.len() > LONGEST_ID_BYTES => Fault::LongId {
                bytes: cell.len(),
                most: LONGEST_ID_BYTES,
            },
            Values::Texts(texts) => {
                texts.push(cell.to_owned());
                return Ok(TEXT_BYTES + cell.len() as u64);
            }
            Values::Integers(integers) => match cell::integer(cell) {
                Ok(value) => {
                    integers.push(value);
                    return Ok(NUMBER_BYTES);
                }
                Err(fault) => fault,
            },
            Values::Numbers(_) if self.role == Role::Unnamed || self.text.is_some() => {
                return Ok(0);
            }
            Values::Numbers(numbers) => match cell::number(cell) {
                Ok(value) if value.is_nan() && matches!(self.role, Role::Joint(_)) => {
                    Fault::MissingReading
                }
                Ok(value) if value.abs() > LARGEST_READING && self.role.is_measured() => {
                    Fault::ReadingTooLarge {
                        found: cell::shortened(cell),
                        largest: LARGEST_READING,
                    }
                }
                Ok(value) => {
                    numbers.push(value);
                    return Ok(NUMBER_BYTES);
                }
                Err(fault) if self.role == Role::Covariate => {
                    numbers.push(f64::NAN);
                    let first = match fault {
                        Fault::NotFinite { .. } => &mut self.not_finite,
                        _ => &mut self.text,
                    };
                    first.get_or_insert_with(|| (line, cell::shortened(cell)));
                    return Ok(NUMBER_BYTES);
                }
                Err(fault) => fault,
            },
        };
        Err(Place::cell(file, line, self.number, &self.name).error(fault))
    }

    /// Adds a number, `NaN` for none, by the rules of [`Column::push`]; returns the memory that it takes
    /// \[bytes\].
    pub(crate) fn push_number(
        &mut self,
        value: f64,
        line: u64,
        file: &str,
    ) -> Result<u64, DataError> {
        let is_beyond = value.abs() > LARGEST_READING && self.role.is_measured();
        match &mut self.values {
            Values::Numbers(numbers)
                if self.role != Role::Unnamed
                    && self.text.is_none()
                    && !value.is_infinite()
                    && !is_beyond
                    && !(value.is_nan() && matches!(self.role, Role::Joint(_))) =>
            {
                numbers.push(value);
                Ok(NUMBER_BYTES)
            }
            _ if value.is_nan() => self.push("", line, file),
            _ => self.push(&value.to_string(), line, file),
        }
    }

    /// The numbers; none with a warning if there is not one reading.
    fn into_numbers(self, file: &str, warnings: &mut Vec<String>) -> Option<Vec<f64>> {
        match self.values {
            Values::Numbers(numbers) if numbers.iter().any(|value| !value.is_nan()) => {
                Some(numbers)
            }
            _ => {
                warnings.push(no_reading(file, self.number, &self.name));
                None
            }
        }
    }

    fn into_texts(self, file: &str, warnings: &mut Vec<String>) -> Option<Vec<String>> {
        match self.values {
            Values::Texts(texts) if texts.iter().any(|text| !text.is_empty()) => Some(texts),
            _ => {
                warnings.push(no_reading(file, self.number, &self.name));
                None
            }
        }
    }
}

fn no_reading(file: &str, number: usize, name: &str) -> String {
    format!("{file}, column {number} `{name}`: no row has a reading; taken as absent")
}

/// The recording of checked columns.
pub(crate) fn assemble(
    mut columns: Vec<Column>,
    lines: Vec<u64>,
    file: &str,
    shape: &LogShape,
) -> Result<LoadedLog, DataError> {
    let n_joints = shape.joints.len();
    let mut warnings = Vec::new();
    let mut groups = Groups {
        columns: &mut columns,
        lines: &lines,
        file,
        warnings: &mut warnings,
    };
    let mut recording = Recording {
        joint: vec![Vec::new(); n_joints],
        output: vec![None; n_joints],
        torque_nm: vec![None; n_joints],
        cable_m: vec![None; shape.cable_count],
        position_m: groups.take(&POSITION, Role::Position),
        orientation_wxyz: groups.take(&ORIENTATION, Role::Orientation),
        force_n: groups.take(&FORCE, Role::Force),
        ..Recording::default()
    };
    recording.line = lines;
    for column in columns {
        place_column(column, &mut recording, file, &mut warnings)?;
    }
    // By name, so that the order of the columns in the file changes nothing.
    recording.covariates.sort_by(|(a, _), (b, _)| a.cmp(b));
    Ok(LoadedLog {
        recording,
        warnings,
    })
}

fn place_column(
    column: Column,
    recording: &mut Recording,
    file: &str,
    warnings: &mut Vec<String>,
) -> Result<(), DataError> {
    let (name, number) = (column.name.clone(), column.number);
    match column.role {
        Role::Time => recording.time_s = column.into_numbers(file, warnings),
        Role::Temperature => recording.temperature_degc = column.into_numbers(file, warnings),
        Role::Hand => {
            if let Values::Texts(hands) = column.values {
                recording.hand = Some(hands);
            }
        }
        Role::Contact => recording.contact = column.into_texts(file, warnings),
        Role::Plane => recording.plane = column.into_texts(file, warnings),
        Role::Tool => recording.tool = column.into_texts(file, warnings),
        Role::Run => {
            if let Values::Integers(runs) = column.values {
                recording.run = Some(runs);
            }
        }
        Role::Joint(joint) => {
            if let Values::Numbers(numbers) = column.values {
                recording.joint[joint] = numbers;
            }
        }
        Role::Output(joint) => recording.output[joint] = column.into_numbers(file, warnings),
        Role::Torque(joint) => recording.torque_nm[joint] = column.into_numbers(file, warnings),
        Role::Cable(cable) => recording.cable_m[cable] = column.into_numbers(file, warnings),
        Role::Covariate => {
            if let Some((line, text)) = &column.text {
                let at = Place::cell(file, *line, number, &name);
                warnings.push(format!(
                    "{at}: `{text}` is no number; the column is left out"
                ));
            } else if let Some((line, text)) = &column.not_finite {
                let at = Place::cell(file, *line, number, &name);
                return Err(at.error(Fault::NotFinite {
                    found: text.clone(),
                }));
            } else if let Some(numbers) = column.into_numbers(file, warnings) {
                recording.covariates.push((name, numbers));
            }
        }
        // Left out with a warning, taken as a group, or refused while the header was read.
        Role::Unnamed
        | Role::Position(_)
        | Role::Orientation(_)
        | Role::Force(_)
        | Role::WrongUnit(_) => {}
    }
    Ok(())
}
