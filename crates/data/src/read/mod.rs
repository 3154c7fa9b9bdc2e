//! A log file to a recording.

pub(crate) mod assemble;
pub(crate) mod cell;
pub(crate) mod format;
pub(crate) mod groups;
pub(crate) mod hands;
pub(crate) mod header;
pub(crate) mod known;
pub(crate) mod limits;
pub(crate) mod order;
pub(crate) mod orientation;
pub(crate) mod rows;
pub(crate) mod source;
pub(crate) mod table;

use std::fs::File;
use std::io::{Cursor, Read};
use std::path::Path;

use haptical_model::Recording;

use crate::error::place::Place;
use crate::error::{DataError, Fault};
use crate::json_lines;
use crate::read::format::{Format, is_json, read_binary};
use crate::read::header::Header;
use crate::read::rows::Rows;
use crate::read::source::{N_FIRST, TextStream, first_bytes, open_error};
use crate::read::table::Table;
use crate::shape::LogShape;
use crate::size::{MOST_COLUMNS, MOST_MEMORY_BYTES};

/// A log that was read, and what was odd about it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LoadedLog {
    /// The measurements.
    pub recording: Recording,
    /// What the user should know: columns left out, readings outside the limits. One sentence
    /// each, with file, line and column.
    pub warnings: Vec<String>,
}

/// Reads a log: CSV or JSON lines, plain or gzip, and with the features of these names Parquet, MCAP and the bags of rosbag2.
/// What it is is recognised by its first bytes, not by its name.
///
/// In errors and warnings the first row of a Parquet file or of a bag's joint states is line 2, as in
/// the CSV log of the same rows.
///
/// # Errors
/// Everything that can be wrong with a log is a variant of [`DataError`].
pub fn read_log(path: &Path, shape: &LogShape) -> Result<LoadedLog, DataError> {
    let name = path.display().to_string();
    if path.join("metadata.yaml").is_file() {
        return Err(Place::file(&name).error(Fault::NotALog {
            what: "this is the folder of a bag of ROS 2".to_owned(),
            advice: "give the .mcap or .db3 file in it; merge several: ros2 bag convert".to_owned(),
        }));
    }
    let file = File::open(path).map_err(|source| open_error(&name, source))?;
    read_log_from(file, &name, shape)
}

/// Reads a log as [`read_log`] from a reader that errors call `name`.
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
/// let shape = LogShape { joints: vec![joint], cable_count: 0, hands: Vec::new() };
/// let error = read_log_from("theta1_rad\n0.1\n0,2\n".as_bytes(), "log.csv", &shape).unwrap_err();
/// assert_eq!((error.kind(), error.line()), ("cell-count", Some(3)));
/// ```
pub fn read_log_from(
    reader: impl Read,
    name: &str,
    shape: &LogShape,
) -> Result<LoadedLog, DataError> {
    shape.check(name)?;
    let mut reader = reader;
    let first = first_bytes(&mut reader, N_FIRST)
        .map_err(|source| Place::file(name).error(Fault::Unreadable { source }))?;
    known::refuse(&first, name)?;
    let format = Format::detect(&first);
    let whole = Cursor::new(first).chain(reader);
    if !matches!(format, Format::Text | Format::JsonLines) {
        return read_binary(format, whole, name, shape);
    }
    let text = TextStream::new(whole, name)?;
    if is_json(text.first()) {
        return json_lines::read(text, name, shape);
    }
    let mut rows = Rows::new(text, name);
    let table = parse(&mut rows, name, shape, MOST_MEMORY_BYTES);
    let table = table.map_err(|refusal| rows.explain(refusal))?;
    drop(rows);
    table.finish()
}

/// The rows, in this memory at most.
fn parse<'a>(
    rows: &mut Rows<'_>,
    name: &'a str,
    shape: &'a LogShape,
    most_bytes: u64,
) -> Result<Table<'a>, DataError> {
    let mut table = Table::with_header(read_header(rows, name, shape)?, name, shape);
    table.most_bytes = most_bytes;
    while let Some((line, record)) = rows.next()? {
        table.push_row(record, line)?;
    }
    Ok(table)
}

fn read_header(rows: &mut Rows<'_>, name: &str, shape: &LogShape) -> Result<Header, DataError> {
    let Some((line, record)) = rows.next()? else {
        return Err(Place::line(name, 1).error(Fault::NoHeader {
            found: String::new(),
        }));
    };
    let columns = record.len();
    if columns > MOST_COLUMNS {
        return Err(Place::line(name, line).error(Fault::TooManyColumns {
            columns,
            most: MOST_COLUMNS,
        }));
    }
    let header = record.clone();
    rows.check_separator(line)?;
    Header::new(&header, line, name, shape)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::JointShape;

    /// 24 bytes a row: line, joint, and a covariate; 8 + 8 + 24 + 2 with a contact of two letters.
    #[test]
    fn rows_are_refused_where_they_fill_the_memory() {
        let joint = JointShape {
            name: "1".into(),
            prismatic: false,
            lower: -1.0,
            upper: 1.0,
        };
        let shape = LogShape {
            joints: vec![joint],
            cable_count: 0,
            hands: Vec::new(),
        };
        let read = |text: &str, most_bytes| {
            let text = TextStream::new(text.as_bytes(), "log.csv").unwrap();
            let mut rows = Rows::new(text, "log.csv");
            parse(&mut rows, "log.csv", &shape, most_bytes).map(|table| table.lines.len())
        };
        for (text, row_bytes) in [
            ("theta1_rad,other\n0.1,1\n0.2,2\n0.3,\n", 24),
            ("theta1_rad,contact\n0.1,ab\n0.2,cd\n0.3,ef\n", 42),
        ] {
            assert_eq!(read(text, 3 * row_bytes).unwrap(), 3);
            let error = read(text, 3 * row_bytes - 1).unwrap_err();
            assert_eq!((error.kind(), error.line()), ("too-large", Some(4)));
            assert!(error.to_string().contains("the 3 rows so far"), "{error}");
        }
    }
}
