//! A file to a table, by its first bytes and its content.

mod clock;
mod decode;
mod dialect;
mod grid;
mod head;
mod motive;
mod number;
#[cfg(feature = "archives")]
mod sheet;
mod text;

use std::fs::File;
use std::io::{Cursor, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;
use haptical_data::{JsonCell, JsonColumns, JsonRefusal, MOST_COLUMNS, MOST_MEMORY_BYTES};

use crate::arrays;
use crate::error::TableError;
use crate::mapping::Reading;
use crate::table::{Cells, Column, Table};

const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];

/// Reads a table: text (comma, semicolon, tab, bar or blanks between cells; plain or gzip), JSON lines, Parquet, `.npy`, `.npz`,
/// `.mat` of version 5 to 7, `.xlsx`.
///
/// # Errors
/// The file cannot be read, is none of these, is damaged, or is larger than a log may be.
pub fn read_table(path: &Path, reading: &Reading) -> Result<Table, TableError> {
    let name = path.display().to_string();
    let unreadable = |error: std::io::Error| {
        let next = "give a table; `haptical import --help` lists the formats and origins";
        TableError::new(
            "unreadable",
            format!("cannot be read: {error}"),
            &name,
            next,
        )
    };
    let file = File::open(path).map_err(unreadable)?;
    let mut bytes = Vec::new();
    let limited = file.take(MOST_MEMORY_BYTES / 2 + 1).read_to_end(&mut bytes);
    limited.map_err(unreadable)?;
    table_from_bytes(bytes, &name, reading)
}

/// Reads a table as [`read_table`] from the bytes of a file that messages call `name`.
///
/// # Errors
/// As [`read_table`].
///
/// # Examples
/// ```
/// use haptical_tables::{Cells, Reading, table_from_bytes};
///
/// let text = "t;q1\n[s];[deg]\n0,5;90\n1,0;-45,5\n";
/// let table = table_from_bytes(text.into(), "log.txt", &Reading::default())?;
/// assert_eq!(table.columns[1].unit.as_deref(), Some("deg"));
/// assert_eq!(table.columns[1].cells, Cells::Numbers(vec![90.0, -45.5]));
/// # Ok::<(), haptical_tables::TableError>(())
/// ```
pub fn table_from_bytes(
    bytes: Vec<u8>,
    name: &str,
    reading: &Reading,
) -> Result<Table, TableError> {
    let bytes = match bytes.starts_with(&GZIP_MAGIC) {
        true => inflated(MultiGzDecoder::new(Cursor::new(bytes)), "gzip", name)?,
        false => bytes,
    };
    if bytes.len() as u64 > MOST_MEMORY_BYTES / 2 {
        return Err(TableError::too_large(name));
    }
    let table = if bytes.starts_with(arrays::NPY_MAGIC) {
        arrays::to_table(vec![arrays::npy(&bytes, "array", name)?], name, reading)?
    } else if bytes.starts_with(arrays::MAT_MAGIC) {
        let found = arrays::mat(&bytes, name)?;
        let mut table = arrays::to_table(found.arrays, name, reading)?;
        table.notes.extend(found.notes);
        table
    } else if bytes.starts_with(b"PK\x03\x04") {
        archive(bytes, name, reading)?
    } else if bytes.starts_with(b"PAR1") {
        parquet(bytes, name)?
    } else if bytes.trim_ascii_start().first() == Some(&b'{') {
        json_lines(&bytes, name)?
    } else {
        refuse_others(&bytes, name)?;
        text::read(&bytes, name, reading)?
    };
    let columns = table.columns.len();
    if columns > MOST_COLUMNS {
        let what = format!("{columns} columns, at most {MOST_COLUMNS} are read");
        let next = "leave out columns that are not needed, or say `transpose = true` in [table]";
        return Err(TableError::new("too-many-columns", what, name, next));
    }
    Ok(table)
}

/// What a decoder gives, as far as the memory goes.
pub(crate) fn inflated(
    decoder: impl Read,
    format: &str,
    name: &str,
) -> Result<Vec<u8>, TableError> {
    let mut bytes = Vec::new();
    let mut limited = decoder.take(MOST_MEMORY_BYTES / 2 + 1);
    let read = limited.read_to_end(&mut bytes);
    read.map_err(|error| TableError::damaged(format, error, name))?;
    match bytes.len() as u64 > MOST_MEMORY_BYTES / 2 {
        true => Err(TableError::too_large(name)),
        false => Ok(bytes),
    }
}

/// Files that are no tables of text, and what to do with them.
fn refuse_others(bytes: &[u8], name: &str) -> Result<(), TableError> {
    let known = haptical_data::known_file(bytes);
    let logs: [(&[u8], &str, &str); 2] = [
        (b"\x89MCAP", "an MCAP file", "use `haptical import bag`"),
        (
            b"SQLite format 3",
            "a bag of rosbag2",
            "use `haptical import bag`",
        ),
    ];
    let log = logs.iter().find(|(magic, _, _)| bytes.starts_with(magic));
    match known.or(log.map(|(_, what, next)| (*what, *next))) {
        None => Ok(()),
        Some((what, next)) => {
            let what = format!("this is {what}, which is not read as a table");
            Err(TableError::new("not-a-table", what, name, next))
        }
    }
}

#[cfg(feature = "archives")]
fn archive(bytes: Vec<u8>, name: &str, reading: &Reading) -> Result<Table, TableError> {
    let entries = arrays::zip_names(&bytes, name)?;
    if entries.iter().any(|entry| entry == "xl/workbook.xml") {
        return sheet::read(bytes, name, reading);
    }
    if entries.iter().any(|entry| entry.ends_with(".npy")) {
        return arrays::to_table(arrays::npz(&bytes, name)?, name, reading);
    }
    let what = "the archive is neither a spreadsheet (.xlsx) nor arrays of NumPy (.npz)";
    Err(TableError::new(
        "not-a-table",
        what,
        name,
        "unpack it, and give the tables in it",
    ))
}

#[cfg(not(feature = "archives"))]
fn archive(_: Vec<u8>, name: &str, _: &Reading) -> Result<Table, TableError> {
    let what = "a spreadsheet (.xlsx) or arrays of NumPy (.npz), which this build does not read";
    let next = "build haptical with `--features archives`, or save it as CSV or .npy";
    Err(TableError::new("not-built-in", what, name, next))
}

#[cfg(feature = "parquet")]
fn parquet(bytes: Vec<u8>, name: &str) -> Result<Table, TableError> {
    let read = haptical_data::parquet_table(bytes, name).map_err(|error| {
        let what = error.fault.to_string();
        TableError::new(error.kind(), what, name, "or save it as CSV")
    })?;
    let columns = read.columns.into_iter();
    let left_out = read.left_out.join(", ");
    Ok(Table {
        file: name.to_owned(),
        columns: columns
            .map(|(own, cells)| Column::numbers(own, cells))
            .collect(),
        is_named: true,
        notes: match left_out.is_empty() {
            true => Vec::new(),
            false => vec![format!("{name}: left out, they are no numbers: {left_out}")],
        },
        ..Table::default()
    })
}

#[cfg(not(feature = "parquet"))]
fn parquet(_: Vec<u8>, name: &str) -> Result<Table, TableError> {
    let next = "build haptical with `--features parquet`, or save it as CSV";
    let what = "a Parquet file, which this build does not read";
    Err(TableError::new("not-built-in", what, name, next))
}

fn json_lines(bytes: &[u8], name: &str) -> Result<Table, TableError> {
    let (text, is_latin1) = decode::text(bytes, None, name)?;
    let mut columns = JsonColumns::default();
    let mut notes = Vec::new();
    let lines = text.lines().zip(1..);
    let mut lines = lines.filter(|(line, _)| !line.trim().is_empty()).peekable();
    while let Some((line, number)) = lines.next() {
        let is_open = !line.trim_end().ends_with('}') && !text.ends_with(['\n', '\r']);
        if is_open && lines.peek().is_none() && !columns.lines.is_empty() {
            notes.push(format!(
                "{name}: line {number}, the last, is cut off and left out"
            ));
            break;
        }
        columns.push(line, number).map_err(|refusal| {
            let (kind, next) = match refusal {
                JsonRefusal::TooManyKeys => {
                    ("too-many-columns", "leave out keys that are not needed")
                }
                _ => ("not-a-table", "write one JSON object a line"),
            };
            TableError::new(kind, refusal.to_string(), name, next).at(number, None)
        })?;
    }
    let named = columns.names.into_iter().zip(columns.cells);
    let columns_of = named.map(|(name, cells)| {
        let is_text = cells.iter().any(|cell| matches!(cell, JsonCell::Text(_)));
        if !is_text {
            return Column::numbers(name, cells.iter().map(json_number).collect());
        }
        let texts: Vec<String> = cells.into_iter().map(json_text).collect();
        let seconds = clock::column(texts.iter().map(String::as_str));
        Column {
            name,
            unit: seconds.is_some().then(|| "s".to_owned()),
            cells: seconds.map_or(Cells::Texts(texts), Cells::Numbers),
        }
    });
    let mut table = Table {
        file: name.to_owned(),
        columns: columns_of.collect(),
        is_named: true,
        lines: columns.lines,
        notes,
        ..Table::default()
    };
    if is_latin1 {
        table
            .notes
            .push(format!("{name}: read as Latin-1, it is no UTF-8"));
    }
    Ok(table)
}

fn json_number(cell: &JsonCell) -> f64 {
    match cell {
        JsonCell::Number(number) => *number,
        _ => f64::NAN,
    }
}

fn json_text(cell: JsonCell) -> String {
    match cell {
        JsonCell::Text(text) => text,
        JsonCell::Number(number) => number.to_string(),
        JsonCell::None => String::new(),
    }
}
