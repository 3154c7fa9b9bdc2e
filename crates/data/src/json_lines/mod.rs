//! JSON lines to a recording, through the checks of a CSV log: an object in each line, its keys are columns.

mod columns;
mod joints;

use std::io::{BufRead, BufReader};

use csv::StringRecord;

pub use self::columns::{JsonCell, JsonColumns, JsonRefusal};
use crate::error::place::Place;
use crate::error::{DataError, Fault};
use crate::read::LoadedLog;
use crate::read::header::Header;
use crate::read::source::TextStream;
use crate::read::table::Table;
use crate::shape::LogShape;
use crate::size::MOST_COLUMNS;

/// Reads a log whose keys have the names of a CSV log, or are those of a joint state of ROS 2.
pub(crate) fn read(
    text: TextStream<'_>,
    name: &str,
    shape: &LogShape,
) -> Result<LoadedLog, DataError> {
    let mut columns = objects(text, name)?;
    joints::rename(&mut columns, name, shape)?;
    if columns.names.len() > MOST_COLUMNS {
        return Err(Place::file(name).error(Fault::TooManyColumns {
            columns: columns.names.len(),
            most: MOST_COLUMNS,
        }));
    }
    let names: StringRecord = columns.names.iter().collect();
    let first = columns.lines.first().copied().unwrap_or(1);
    let mut table = Table::with_header(Header::new(&names, first, name, shape)?, name, shape);
    let mut record = StringRecord::new();
    for (row, &line) in columns.lines.iter().enumerate() {
        record.clear();
        for column in &columns.cells {
            match &column[row] {
                JsonCell::None => record.push_field(""),
                JsonCell::Number(value) => record.push_field(&value.to_string()),
                JsonCell::Text(text) => record.push_field(text),
            }
        }
        table.push_row(&record, line)?;
    }
    table.finish()
}

/// The objects of a text, line by line.
fn objects(text: TextStream<'_>, name: &str) -> Result<JsonColumns, DataError> {
    let mut columns = JsonColumns::default();
    let mut reader = BufReader::new(text);
    let (mut line, mut number) = (String::new(), 0);
    loop {
        line.clear();
        number += 1;
        match reader.read_line(&mut line) {
            Ok(0) => return Ok(columns),
            Ok(_) => {}
            Err(source) => {
                let fault = reader.get_mut().take_fault();
                let unreadable = || Place::file(name).error(Fault::Unreadable { source });
                return Err(fault.unwrap_or_else(unreadable));
            }
        }
        if line.trim().is_empty() {
            continue;
        }
        let refuse = |refusal: JsonRefusal| {
            Place::line(name, number).error(match refusal {
                JsonRefusal::TooManyKeys => Fault::TooManyKeys { most: MOST_COLUMNS },
                JsonRefusal::NoRow(what) => Fault::NotALog {
                    what,
                    advice:
                        "write one JSON object a line, such as {\"t_s\": 0.0, \"theta1_rad\": 0.1}"
                            .to_owned(),
                },
            })
        };
        columns.push(&line, number).map_err(refuse)?;
        reader.get_mut().row_was_taken();
    }
}
