//! Parquet files to a recording, through the checks of a CSV log.

use std::io::Read;
use std::panic::{AssertUnwindSafe, catch_unwind};

use bytes::Bytes;
use parquet::basic::{Compression, LogicalType, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType};
use parquet::errors::ParquetError;
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::{ColumnDescriptor, SchemaDescriptor};

use crate::error::place::Place;
use crate::error::{DataError, Fault};
use crate::read::LoadedLog;
use crate::read::table::{Cell, Table};
use crate::shape::LogShape;
use crate::size::MOST_MEMORY_BYTES;

/// Cells that are decoded at a time.
const BATCH_ROWS: usize = 1 << 12;

/// Reads a log whose columns have the names of a CSV log.
pub(crate) fn read(
    reader: impl Read,
    name: &str,
    shape: &LogShape,
) -> Result<LoadedLog, DataError> {
    let content = content(reader, name)?;
    // The library panics on some damaged files; what it was at work on is dropped then.
    let read = AssertUnwindSafe(|| read_content(content, name, shape));
    catch_unwind(read).unwrap_or_else(|_| Err(cut_short(Place::file(name), "its parts contradict")))
}

fn read_content(content: Bytes, name: &str, shape: &LogShape) -> Result<LoadedLog, DataError> {
    let file = SerializedFileReader::new(content).map_err(|error| damaged(name, &error))?;
    let metadata = file.metadata();
    let schema = metadata.file_metadata().schema_descr();
    check_columns(schema, name)?;
    let names = schema.columns().iter().map(|column| column.name());
    let mut table = Table::new(names, name, shape)?;
    for index in 0..metadata.num_row_groups() {
        let group = file.get_row_group(index).map_err(|e| damaged(name, &e))?;
        let n_rows = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        for (column, descriptor) in schema.columns().iter().enumerate() {
            let at = Place::column(name, column + 1, descriptor.name());
            check_chunk(group.metadata().column(column), at)?;
            let reader = group.get_column_reader(column);
            let mut cells = ColumnCells {
                table: &mut table,
                name,
                column,
                descriptor,
                n_rows,
            };
            cells.read(reader.map_err(|e| damaged(name, &e))?)?;
        }
    }
    table.finish()
}

/// The whole file: its directory is at its end.
pub(crate) fn content(reader: impl Read, name: &str) -> Result<Bytes, DataError> {
    let mut content = Vec::new();
    let mut limited = reader.take(MOST_MEMORY_BYTES + 1);
    let read = limited.read_to_end(&mut content);
    read.map_err(|source| Place::file(name).error(Fault::Unreadable { source }))?;
    if content.len() as u64 > MOST_MEMORY_BYTES {
        return Err(refused(
            Place::file(name),
            format!("the file is larger than {} GiB", MOST_MEMORY_BYTES >> 30),
            "leave out columns that are not needed, or split the log",
        ));
    }
    Ok(Bytes::from(content))
}

pub(crate) fn damaged(name: &str, error: &ParquetError) -> DataError {
    cut_short(Place::file(name), error.to_string())
}

pub(crate) fn cut_short(at: Box<Place>, what: impl Into<String>) -> DataError {
    at.error(Fault::Damaged {
        format: "Parquet",
        what: what.into(),
    })
}

pub(crate) fn refused(at: Box<Place>, what: String, advice: &str) -> DataError {
    at.error(Fault::NotALog {
        what,
        advice: advice.to_owned(),
    })
}

/// A log is a flat table of numbers and texts.
fn check_columns(schema: &SchemaDescriptor, name: &str) -> Result<(), DataError> {
    for (index, column) in schema.columns().iter().enumerate() {
        let header = column.path().string();
        let at = Place::column(name, index + 1, &header);
        if column.max_rep_level() > 0 || column.path().parts().len() > 1 {
            let advice = match is_of_lerobot(schema) {
                true => {
                    "this is a file of a LeRobot data set: `haptical import lerobot` makes a log of it"
                }
                false => {
                    "write each part as a column of its own, with one number or text in each row"
                }
            };
            let what = "the column is a list or a structure".to_owned();
            return Err(refused(at, what, advice));
        }
        let advice = match (column.logical_type_ref(), column.physical_type()) {
            (
                Some(LogicalType::Timestamp { .. } | LogicalType::Time { .. } | LogicalType::Date),
                _,
            )
            | (_, Type::INT96) => "write times as seconds in a column of numbers, t_s",
            (Some(LogicalType::Decimal { .. }), _) => "write numbers as double or float",
            (_, Type::FIXED_LEN_BYTE_ARRAY) => "write numbers as double, and texts as strings",
            _ => continue,
        };
        let found = column.logical_type_ref().map_or_else(
            || column.physical_type().to_string(),
            |logical| format!("{logical:?}"),
        );
        let what = format!("a column of type {found} is no column of numbers or texts");
        return Err(refused(at, what, advice));
    }
    Ok(())
}

/// Whether the columns are those of a LeRobot data set.
fn is_of_lerobot(schema: &SchemaDescriptor) -> bool {
    let has = |name: &str| {
        let mut columns = schema.columns().iter();
        columns.any(|column| column.path().parts().first().is_some_and(|own| own == name))
    };
    has("action") && has("observation.state")
}

/// A part of a column that can be read: its place in the file, its codec.
pub(crate) fn check_chunk(chunk: &ColumnChunkMetaData, at: Box<Place>) -> Result<(), DataError> {
    let offsets = [
        chunk.dictionary_page_offset().unwrap_or(0),
        chunk.data_page_offset(),
        chunk.compressed_size(),
    ];
    if offsets.iter().any(|&offset| offset < 0) {
        return Err(cut_short(at, "a place before the file's begin"));
    }
    let codec = chunk.compression();
    let is_known = matches!(
        codec,
        Compression::UNCOMPRESSED
            | Compression::SNAPPY
            | Compression::GZIP(_)
            | Compression::LZ4
            | Compression::LZ4_RAW
    );
    if is_known {
        return Ok(());
    }
    Err(refused(
        at,
        format!("the column is compressed with {codec}, which is not read"),
        "write the file with compression \"snappy\", \"gzip\", \"lz4\" or none",
    ))
}

/// One column of one row group.
struct ColumnCells<'t, 'a> {
    table: &'t mut Table<'a>,
    name: &'t str,
    column: usize,
    descriptor: &'t ColumnDescriptor,
    n_rows: usize,
}

impl ColumnCells<'_, '_> {
    fn read(&mut self, reader: ColumnReader) -> Result<(), DataError> {
        match reader {
            ColumnReader::BoolColumnReader(reader) => {
                self.cells(reader, |value| Ok(Cell::Integer(i64::from(*value))))
            }
            ColumnReader::Int32ColumnReader(reader) => {
                self.cells(reader, |value| Ok(Cell::Integer(i64::from(*value))))
            }
            ColumnReader::Int64ColumnReader(reader) => {
                self.cells(reader, |value| Ok(Cell::Integer(*value)))
            }
            ColumnReader::FloatColumnReader(reader) => {
                self.cells(reader, |value| Ok(Cell::Number(f64::from(*value))))
            }
            ColumnReader::DoubleColumnReader(reader) => {
                self.cells(reader, |value| Ok(Cell::Number(*value)))
            }
            ColumnReader::ByteArrayColumnReader(reader) => {
                let at = self.place();
                let advice = "write texts as UTF-8 strings";
                let what = "the column has texts that are not UTF-8";
                self.cells(reader, |value: &ByteArray| {
                    let text = std::str::from_utf8(value.data()).map(Cell::Text);
                    text.map_err(|_| refused(at.clone(), what.to_owned(), advice))
                })
            }
            // refused with the schema
            ColumnReader::Int96ColumnReader(_) | ColumnReader::FixedLenByteArrayColumnReader(_) => {
                self.cut_off(0)
            }
        }
    }

    /// Pushes all cells; a cell without a value is an empty one.
    fn cells<T: DataType>(
        &mut self,
        mut reader: ColumnReaderImpl<T>,
        cell: impl for<'v> Fn(&'v T::T) -> Result<Cell<'v>, DataError>,
    ) -> Result<(), DataError> {
        let most_level = self.descriptor.max_def_level();
        let (mut values, mut levels) = (Vec::new(), Vec::new());
        let mut done = 0;
        while done < self.n_rows {
            values.clear();
            levels.clear();
            let wanted = BATCH_ROWS.min(self.n_rows - done);
            let result = reader.read_records(wanted, Some(&mut levels), None, &mut values);
            let (n_records, n_values, _) = result.map_err(|e| damaged(self.name, &e))?;
            if n_records == 0 {
                return self.cut_off(done);
            }
            let mut present = values.iter().take(n_values);
            for row in 0..n_records {
                // a column that no cell of may be empty has no levels
                let is_present = levels.get(row).is_none_or(|&level| level == most_level);
                let value = if is_present { present.next() } else { None };
                match value {
                    Some(value) => self.table.push(self.column, cell(value)?)?,
                    None if is_present => return self.cut_off(done + row),
                    None => self.table.push(self.column, Cell::Number(f64::NAN))?,
                }
            }
            done += n_records;
        }
        Ok(())
    }

    fn place(&self) -> Box<Place> {
        Place::column(self.name, self.column + 1, self.descriptor.name())
    }

    fn cut_off(&self, got: usize) -> Result<(), DataError> {
        let wanted = self.n_rows;
        let what = format!("{got} cells where {wanted} are announced");
        Err(cut_short(self.place(), what))
    }
}
