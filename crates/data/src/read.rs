//! A log file to a recording.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use haptical_model::Recording;

use crate::assemble::{Column, assemble};
use crate::error::DataError;
use crate::header::Header;
use crate::place::Place;
use crate::rows::{Rows, check_separator};
use crate::shape::LogShape;
use crate::source::{open_error, read_text};
use crate::{limits, order, orientation};

/// A log that was read, and what was odd about it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LoadedLog {
    /// The measurements.
    pub recording: Recording,
    /// What the user should know: columns left out, readings outside the limits. One sentence
    /// each, with file, line and column.
    pub warnings: Vec<String>,
}

/// Reads a log, plain or gzip (told by its first bytes, not by its name).
///
/// # Errors
/// Everything that can be wrong with a log is a variant of [`DataError`].
pub fn read_log(path: &Path, shape: &LogShape) -> Result<LoadedLog, DataError> {
    let name = path.display().to_string();
    let file = File::open(path).map_err(|source| open_error(&name, source))?;
    read_log_from(file, &name, shape)
}

/// Reads a log, plain or gzip, from a reader that errors call `name`.
///
/// # Errors
/// As [`read_log`].
///
/// # Examples
/// ```
/// use haptical_data::{JointShape, LogShape, read_log_from};
///
/// let limit = std::f64::consts::FRAC_PI_2;
/// let joint = JointShape { name: "elbow".into(), prismatic: false, lower: -limit, upper: limit };
/// let shape = LogShape { joints: vec![joint], cable_count: 0 };
/// let error = read_log_from("theta1_rad\n0.1\n0,2\n".as_bytes(), "log.csv", &shape).unwrap_err();
/// assert_eq!((error.kind(), error.line()), ("cell-count", Some(3)));
/// ```
pub fn read_log_from(
    reader: impl Read,
    name: &str,
    shape: &LogShape,
) -> Result<LoadedLog, DataError> {
    if shape.joints.is_empty() {
        return Err(DataError::InvalidShape {
            at: Place::file(name),
        });
    }
    let text = read_text(reader, name)?;
    let (header, lines, columns) = parse(&text, name, shape)?;
    drop(text);
    check_row_count(&lines, header.line, name)?;
    let mut log = assemble(columns, lines, name, shape)?;
    log.warnings.splice(0..0, header.warnings);
    order::check(&log.recording, &header.columns, name)?;
    orientation::normalise(&mut log.recording, &header.columns, name)?;
    order::check_distances(&log.recording, &header.columns, name)?;
    log.warnings
        .extend(limits::check(&log.recording, &header.columns, name, shape)?);
    Ok(log)
}

/// The header, the line of each row, and the columns.
fn parse(
    text: &str,
    name: &str,
    shape: &LogShape,
) -> Result<(Header, Vec<u64>, Vec<Column>), DataError> {
    let mut rows = Rows::new(text, name);
    let header = read_header(&mut rows, text, name, shape)?;
    let mut columns: Vec<Column> = header
        .columns
        .iter()
        .enumerate()
        .map(|(index, (column, role))| Column::new(column, index + 1, *role))
        .collect();
    let mut lines = Vec::new();
    while let Some((line, record)) = rows.next()? {
        if record.len() != columns.len() {
            return Err(DataError::CellCount {
                at: Place::line(name, line),
                got: record.len(),
                expected: columns.len(),
                advice: cell_count_advice(record, columns.len()),
            });
        }
        for (column, cell) in columns.iter_mut().zip(record) {
            column.push(cell.trim(), line, name)?;
        }
        lines.push(line);
    }
    Ok((header, lines, columns))
}

fn read_header(
    rows: &mut Rows<'_>,
    text: &str,
    name: &str,
    shape: &LogShape,
) -> Result<Header, DataError> {
    match rows.next()? {
        None => Err(DataError::NoHeader {
            at: Place::line(name, 1),
            found: String::new(),
        }),
        Some((line, record)) => {
            let first = text
                .lines()
                .find(|line| !line.trim().is_empty())
                .unwrap_or_default();
            check_separator(first, name, line)?;
            Header::new(record, line, name, shape)
        }
    }
}

fn check_row_count(lines: &[u64], header_line: u64, name: &str) -> Result<(), DataError> {
    match lines {
        [] => Err(DataError::NoRows {
            at: Place::line(name, header_line),
        }),
        [only] => Err(DataError::TooFewRows {
            at: Place::line(name, *only),
            rows: 1,
        }),
        _ => Ok(()),
    }
}

/// What a row with a wrong number of cells probably is.
fn cell_count_advice(record: &csv::StringRecord, expected: usize) -> &'static str {
    let is_integer = |cell: &str| {
        let digits = cell.trim().trim_start_matches(['-', '+']);
        digits.bytes().all(|byte| byte.is_ascii_digit())
    };
    if record.len() < expected {
        "the row is cut off or a comma is missing: delete the row or complete it"
    } else if record.iter().all(is_integer) {
        "it looks like a comma as decimal sign: export the log again with a point"
    } else {
        "there is a comma too many, or the header is not complete: correct the row"
    }
}
