//! Columns of typed cells, as a program or a binary file has them, to a recording: the checks of a CSV log.

use csv::StringRecord;

use crate::error::place::Place;
use crate::error::{DataError, Fault};
use crate::read::assemble::{Column, assemble};
use crate::read::header::Header;
use crate::read::{LoadedLog, hands, limits, order, orientation};
use crate::shape::LogShape;
use crate::size::{MOST_COLUMNS, MOST_MEMORY_BYTES, NUMBER_BYTES};

/// Cells of one column, one for each row.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Cells<'a> {
    /// Numbers in the unit of the column's name; `NaN` is no reading.
    Numbers(&'a [f64]),
    /// Integers, such as numbers of runs.
    Integers(&'a [i64]),
    /// Texts, such as names of contacts; an empty one is no reading.
    Texts(&'a [String]),
}

impl Cells<'_> {
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Numbers(cells) => cells.len(),
            Self::Integers(cells) => cells.len(),
            Self::Texts(cells) => cells.len(),
        }
    }
}

/// Takes columns in memory for a log, with the names and the checks of a CSV log; errors call it `name`.
///
/// In errors and warnings the first row is line 2, as in the CSV log of the same rows.
///
/// # Errors
/// [`Fault::NotALog`] for columns of unequal length; otherwise as [`read_log`](crate::read_log).
///
/// # Examples
/// ```
/// use haptical_data::{Cells, JointShape, LogShape, log_from_columns};
///
/// let joint = JointShape { name: "1".into(), prismatic: false, lower: -1.5, upper: 1.5 };
/// let shape = LogShape { joints: vec![joint], cable_count: 1, hands: Vec::new() };
/// let columns = [
///     ("theta1_rad", Cells::Numbers(&[0.1, 0.2])),
///     ("cable_m", Cells::Numbers(&[0.25, f64::NAN])),
/// ];
/// let log = log_from_columns(&columns, "the recording", &shape)?;
/// assert_eq!(log.recording.joint[0], [0.1, 0.2]);
///
/// let faulty = [("theta1_rad", Cells::Numbers(&[0.1, f64::NAN]))];
/// let error = log_from_columns(&faulty, "the recording", &shape).unwrap_err();
/// assert_eq!((error.kind(), error.line()), ("missing-reading", Some(3)));
/// # Ok::<(), haptical_data::DataError>(())
/// ```
pub fn log_from_columns(
    columns: &[(&str, Cells<'_>)],
    name: &str,
    shape: &LogShape,
) -> Result<LoadedLog, DataError> {
    let mut table = Table::new(columns.iter().map(|(name, _)| *name), name, shape)?;
    let n_rows = columns.first().map_or(0, |(_, cells)| cells.len());
    for (index, (header, cells)) in columns.iter().enumerate() {
        if cells.len() != n_rows {
            let at = Place::column(name, index + 1, header);
            return Err(at.error(Fault::NotALog {
                what: format!(
                    "the column has {} rows, the first one {n_rows}",
                    cells.len()
                ),
                advice: "give all columns the same number of rows".to_owned(),
            }));
        }
    }
    for (index, (_, cells)) in columns.iter().enumerate() {
        match cells {
            Cells::Numbers(cells) => {
                for &value in *cells {
                    table.push(index, Cell::Number(value))?;
                }
            }
            Cells::Integers(cells) => {
                for &value in *cells {
                    table.push(index, Cell::Integer(value))?;
                }
            }
            Cells::Texts(cells) => {
                for text in *cells {
                    table.push(index, Cell::Text(text))?;
                }
            }
        }
    }
    table.finish()
}

/// One cell.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Cell<'a> {
    /// `NaN` is no reading.
    Number(f64),
    Integer(i64),
    /// Blanks at its ends do not count.
    Text(&'a str),
}

/// A log that is filled row by row, or cell by cell in any order of the columns.
#[derive(Debug)]
pub(crate) struct Table<'a> {
    name: &'a str,
    shape: &'a LogShape,
    header: Header,
    columns: Vec<Column>,
    /// Line of each row.
    pub(super) lines: Vec<u64>,
    /// Rows so far, by column, of a log that is filled cell by cell.
    n_rows: Vec<u64>,
    memory_bytes: u64,
    pub(super) most_bytes: u64,
}

/// Line of the first row: the header is line 1.
const FIRST_LINE: u64 = 2;

impl<'a> Table<'a> {
    /// A log with these columns and no rows.
    pub(crate) fn new<'n>(
        names: impl ExactSizeIterator<Item = &'n str>,
        name: &'a str,
        shape: &'a LogShape,
    ) -> Result<Self, DataError> {
        shape.check(name)?;
        if names.len() > MOST_COLUMNS {
            return Err(Place::file(name).error(Fault::TooManyColumns {
                columns: names.len(),
                most: MOST_COLUMNS,
            }));
        }
        let header = Header::new(&names.collect::<StringRecord>(), 1, name, shape)?;
        Ok(Self::with_header(header, name, shape))
    }

    /// A log with a checked header and no rows.
    pub(crate) fn with_header(header: Header, name: &'a str, shape: &'a LogShape) -> Self {
        let named = header.columns.iter().enumerate();
        let columns: Vec<Column> = named
            .map(|(index, (column, role))| Column::new(column, index + 1, *role))
            .collect();
        Self {
            name,
            shape,
            n_rows: vec![0; columns.len()],
            header,
            columns,
            lines: Vec::new(),
            memory_bytes: 0,
            most_bytes: MOST_MEMORY_BYTES,
        }
    }

    /// Adds the cells of a line.
    pub(crate) fn push_row(&mut self, record: &StringRecord, line: u64) -> Result<(), DataError> {
        if record.len() != self.columns.len() {
            return Err(Place::line(self.name, line).error(Fault::CellCount {
                got: record.len(),
                expected: self.columns.len(),
                advice: cell_count_advice(record, self.columns.len()),
            }));
        }
        for (column, cell) in self.columns.iter_mut().zip(record) {
            self.memory_bytes += column.push(cell.trim(), line, self.name)?;
        }
        self.lines.push(line);
        self.memory_bytes += NUMBER_BYTES;
        self.check_memory(line, self.lines.len())
    }

    /// Adds a cell to the column at `index`, which is below the number of names.
    pub(crate) fn push(&mut self, index: usize, cell: Cell<'_>) -> Result<(), DataError> {
        let (column, row) = (&mut self.columns[index], &mut self.n_rows[index]);
        let line = *row + FIRST_LINE;
        *row += 1;
        self.memory_bytes += match cell {
            Cell::Number(value) => column.push_number(value, line, self.name),
            Cell::Integer(value) => column.push(&value.to_string(), line, self.name),
            Cell::Text(text) => column.push(text.trim(), line, self.name),
        }?;
        let rows = usize::try_from(*row).unwrap_or(usize::MAX);
        if index == 0 {
            self.lines.push(line);
            self.memory_bytes += NUMBER_BYTES;
        }
        self.check_memory(line, rows)
    }

    fn check_memory(&self, line: u64, rows: usize) -> Result<(), DataError> {
        if self.memory_bytes <= self.most_bytes {
            return Ok(());
        }
        Err(Place::line(self.name, line).error(Fault::TooLarge {
            rows,
            gibibytes: self.most_bytes >> 30,
        }))
    }

    /// The recording, after the checks that need all rows. Every column has the same number of cells.
    pub(crate) fn finish(self) -> Result<LoadedLog, DataError> {
        let (header, name) = (self.header, self.name);
        match self.lines[..] {
            [] => return Err(Place::line(name, header.line).error(Fault::NoRows)),
            [only] => return Err(Place::line(name, only).error(Fault::TooFewRows { rows: 1 })),
            _ => {}
        }
        let mut log = assemble(self.columns, self.lines, name, self.shape)?;
        hands::check(&log.recording, &header, name, self.shape)?;
        log.warnings.splice(0..0, header.warnings);
        order::check(&log.recording, &header.columns, name)?;
        orientation::normalise(&mut log.recording, &header.columns, name)?;
        order::check_distances(&log.recording, &header.columns, name)?;
        let outside = limits::check(&log.recording, &header.columns, name, self.shape)?;
        log.warnings.extend(outside);
        Ok(log)
    }
}

/// What a row with a wrong number of cells probably is.
fn cell_count_advice(record: &StringRecord, expected: usize) -> &'static str {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::JointShape;

    /// As in CSV logs: 24 bytes a row for line, joint and covariate.
    #[test]
    fn cells_are_refused_where_they_fill_the_memory() {
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
        let fill = |most_bytes| {
            let names = ["theta1_rad", "other"];
            let mut table = Table::new(names.into_iter(), "log", &shape)?;
            table.most_bytes = most_bytes;
            for _ in 0..3 {
                for column in 0..2 {
                    table.push(column, Cell::Number(0.5))?;
                }
            }
            table.finish().map(|log| log.recording.len())
        };
        assert_eq!(fill(72).unwrap(), 3);
        let error = fill(71).unwrap_err();
        assert_eq!((error.kind(), error.line()), ("too-large", Some(4)));
    }
}
