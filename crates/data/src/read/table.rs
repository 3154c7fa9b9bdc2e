//! Columns of typed cells, as a program or a binary file has them, to a recording: the checks of a CSV log.

use csv::StringRecord;

use crate::error::DataError;
use crate::error::place::Place;
use crate::read::assemble::Column;
use crate::read::header::Header;
use crate::read::{LoadedLog, checked};
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
    fn len(&self) -> usize {
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
/// [`DataError::NotALog`] for columns of unequal length; otherwise as [`read_log`](crate::read_log).
///
/// # Examples
/// ```
/// use haptical_data::{Cells, JointShape, LogShape, log_from_columns};
///
/// let joint = JointShape { name: "1".into(), prismatic: false, lower: -1.5, upper: 1.5 };
/// let shape = LogShape { joints: vec![joint], cable_count: 1 };
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
            let mut at = Place::cell(name, 1, index + 1, header);
            at.line = None;
            return Err(DataError::NotALog {
                at,
                what: format!(
                    "the column has {} rows, the first one {n_rows}",
                    cells.len()
                ),
                advice: "give all columns the same number of rows".to_owned(),
            });
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

/// A log that is filled cell by cell, in any order of the columns.
#[derive(Debug)]
pub(crate) struct Table<'a> {
    name: &'a str,
    shape: &'a LogShape,
    header: Header,
    columns: Vec<Column>,
    /// Rows so far, by column.
    n_rows: Vec<u64>,
    memory_bytes: u64,
    most_bytes: u64,
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
        if shape.joints.is_empty() {
            return Err(DataError::InvalidShape {
                at: Place::file(name),
            });
        }
        if names.len() > MOST_COLUMNS {
            return Err(DataError::TooManyColumns {
                at: Place::file(name),
                columns: names.len(),
                most: MOST_COLUMNS,
            });
        }
        let header = Header::new(&names.collect::<StringRecord>(), 1, name, shape)?;
        let named = header.columns.iter().enumerate();
        let columns: Vec<Column> = named
            .map(|(index, (column, role))| Column::new(column, index + 1, *role))
            .collect();
        Ok(Self {
            name,
            shape,
            n_rows: vec![0; columns.len()],
            header,
            columns,
            memory_bytes: 0,
            most_bytes: MOST_MEMORY_BYTES,
        })
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
        if index == 0 {
            self.memory_bytes += NUMBER_BYTES;
        }
        if self.memory_bytes > self.most_bytes {
            return Err(DataError::TooLarge {
                at: Place::line(self.name, line),
                rows: usize::try_from(*row).unwrap_or(usize::MAX),
                gibibytes: self.most_bytes >> 30,
            });
        }
        Ok(())
    }

    /// The recording, after the checks that need all rows. Every column has the same number of cells.
    pub(crate) fn finish(self) -> Result<LoadedLog, DataError> {
        let n_rows = self.n_rows.first().copied().unwrap_or(0);
        debug_assert!(self.n_rows.iter().all(|&count| count == n_rows));
        let lines = (FIRST_LINE..FIRST_LINE + n_rows).collect();
        checked(self.header, lines, self.columns, self.name, self.shape)
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
