//! Columns of lists and numbers of a Parquet file, by name: data sets of robot learning hold all joints of a row in one list.

use std::fs::File;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use parquet::basic::Type;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use crate::error::DataError;
use crate::error::place::Place;
use crate::parquet_log::{check_chunk, content, cut_short, damaged, refused};
use crate::read::source::open_error;

/// Cells that are decoded at a time.
const BATCH_ROWS: usize = 1 << 12;

/// Columns of a Parquet file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ParquetColumns {
    /// Of each list that was asked for: its elements, one column each.
    pub lists: Vec<Vec<Vec<f64>>>,
    /// Each column of numbers that was asked for; none where the file has it not.
    pub numbers: Vec<Option<Vec<f64>>>,
}

/// Reads lists, which must be there and of one length in all rows, and numbers, which may be absent, from a Parquet file.
///
/// # Errors
/// A file that cannot be read or is no Parquet; a list that is absent, or whose rows are of different lengths.
pub fn read_parquet_columns(
    path: &Path,
    lists: &[&str],
    numbers: &[&str],
) -> Result<ParquetColumns, DataError> {
    let name = path.display().to_string();
    let file = File::open(path).map_err(|source| open_error(&name, source))?;
    let content = content(file, &name)?;
    let read = AssertUnwindSafe(|| {
        let file = SerializedFileReader::new(content).map_err(|error| damaged(&name, &error))?;
        let reader = Reader {
            file: &file,
            name: &name,
        };
        let lists = lists.iter().map(|list| reader.list(list));
        let lists = lists.collect::<Result<_, _>>()?;
        let numbers = numbers.iter().map(|number| reader.number(number));
        Ok(ParquetColumns {
            lists,
            numbers: numbers.collect::<Result<_, _>>()?,
        })
    });
    catch_unwind(read)
        .unwrap_or_else(|_| Err(cut_short(Place::file(&name), "its parts contradict")))
}

/// Names of a Parquet file's columns: a list is one, parts of a structure are joined by points.
///
/// # Errors
/// A file that cannot be read or is no Parquet.
pub fn parquet_names(path: &Path) -> Result<Vec<String>, DataError> {
    let name = path.display().to_string();
    let file = File::open(path).map_err(|source| open_error(&name, source))?;
    let content = content(file, &name)?;
    let read = AssertUnwindSafe(|| {
        let file = SerializedFileReader::new(content).map_err(|error| damaged(&name, &error))?;
        let schema = file.metadata().file_metadata().schema_descr();
        Ok(schema
            .columns()
            .iter()
            .map(|column| name_of(column))
            .collect())
    });
    catch_unwind(read)
        .unwrap_or_else(|_| Err(cut_short(Place::file(&name), "its parts contradict")))
}

/// `q.list.element` is the list `q`.
fn name_of(column: &ColumnDescriptor) -> String {
    let parts = column.path().parts().iter().map(String::as_str);
    let parts: Vec<&str> = match column.max_rep_level() {
        0 => parts.collect(),
        _ => parts
            .take_while(|part| !["list", "bag"].contains(part))
            .collect(),
    };
    parts.join(".")
}

/// All columns of numbers of a Parquet file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ParquetTable {
    /// Names and cells; of a list each element, `q[1]`, `q[2]`, ...; parts of a structure are joined by points.
    pub columns: Vec<(String, Vec<f64>)>,
    /// Names of the columns that have no numbers.
    pub left_out: Vec<String>,
}

/// Reads all columns of numbers, and of lists of one length in all rows, from the bytes of a Parquet file that errors call `name`.
///
/// # Errors
/// The bytes are no Parquet file, or a list has rows of different lengths.
pub fn parquet_table(bytes: Vec<u8>, name: &str) -> Result<ParquetTable, DataError> {
    let read = AssertUnwindSafe(|| {
        let file = SerializedFileReader::new(bytes::Bytes::from(bytes));
        let file = file.map_err(|error| damaged(name, &error))?;
        let reader = Reader { file: &file, name };
        let schema = file.metadata().file_metadata().schema_descr();
        let mut table = ParquetTable::default();
        for (index, column) in schema.columns().iter().enumerate() {
            let own = name_of(column);
            let is_number = matches!(
                column.physical_type(),
                Type::INT32 | Type::INT64 | Type::FLOAT | Type::DOUBLE
            );
            if !is_number || column.max_rep_level() > 1 {
                table.left_out.push(own);
                continue;
            }
            let elements = reader.list_at(index, &own)?;
            let is_list = column.max_rep_level() > 0;
            for (element, cells) in elements.into_iter().enumerate() {
                let name = match is_list {
                    true => format!("{own}[{}]", element + 1),
                    false => own.clone(),
                };
                table.columns.push((name, cells));
            }
        }
        Ok(table)
    });
    catch_unwind(read).unwrap_or_else(|_| Err(cut_short(Place::file(name), "its parts contradict")))
}

struct Reader<'f> {
    file: &'f SerializedFileReader<bytes::Bytes>,
    name: &'f str,
}

impl Reader<'_> {
    fn index(&self, wanted: &str) -> Option<usize> {
        let schema = self.file.metadata().file_metadata().schema_descr();
        let columns = schema.columns();
        let named = columns.iter().position(|column| name_of(column) == wanted);
        // older writers call a list's elements otherwise
        let first = |column: &ColumnDescriptor| {
            column
                .path()
                .parts()
                .first()
                .is_some_and(|first| first == wanted)
        };
        named.or_else(|| columns.iter().position(|column| first(column)))
    }

    /// All cells of a column, with the lengths of the rows.
    fn cells(&self, index: usize) -> Result<(Vec<f64>, Vec<usize>), DataError> {
        let metadata = self.file.metadata();
        let column = metadata.file_metadata().schema_descr().column(index);
        let header = column.path().string();
        let at = || Place::column(self.name, index + 1, &header);
        let (mut values, mut lengths) = (Vec::new(), Vec::new());
        for group in 0..metadata.num_row_groups() {
            let group = self
                .file
                .get_row_group(group)
                .map_err(|e| damaged(self.name, &e))?;
            check_chunk(group.metadata().column(index), at())?;
            let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
            let reader = group
                .get_column_reader(index)
                .map_err(|e| damaged(self.name, &e))?;
            let mut cells = Cells {
                name: self.name,
                rows,
                most: column.max_def_level(),
                repeats: column.max_rep_level() > 0,
                values: &mut values,
                lengths: &mut lengths,
            };
            match reader {
                ColumnReader::FloatColumnReader(reader) => cells.read(reader, |v| f64::from(*v))?,
                ColumnReader::DoubleColumnReader(reader) => cells.read(reader, |v| *v)?,
                ColumnReader::Int64ColumnReader(reader) => cells.read(reader, |v| *v as f64)?,
                ColumnReader::Int32ColumnReader(reader) => {
                    cells.read(reader, |v| f64::from(*v))?;
                }
                _ => {
                    let what = "the column has no numbers".to_owned();
                    return Err(refused(at(), what, "write numbers as float or double"));
                }
            }
        }
        Ok((values, lengths))
    }

    fn number(&self, wanted: &str) -> Result<Option<Vec<f64>>, DataError> {
        let Some(index) = self.index(wanted) else {
            return Ok(None);
        };
        let (values, lengths) = self.cells(index)?;
        match lengths.iter().all(|length| *length == 1) {
            true => Ok(Some(values)),
            false => {
                let at = Place::column(self.name, index + 1, wanted);
                let what = "the column has lists where one number a row is wanted".to_owned();
                Err(refused(at, what, "write one number in each row"))
            }
        }
    }

    fn list(&self, wanted: &str) -> Result<Vec<Vec<f64>>, DataError> {
        let Some(index) = self.index(wanted) else {
            let schema = self.file.metadata().file_metadata().schema_descr();
            let names: Vec<String> = schema
                .columns()
                .iter()
                .map(|column| name_of(column))
                .collect();
            let what = format!("it has no column `{wanted}`, but {}", names.join(", "));
            let advice = "give a data set that has it";
            return Err(refused(Place::file(self.name), what, advice));
        };
        self.list_at(index, wanted)
    }

    /// The elements of a list, which has as many in each row.
    fn list_at(&self, index: usize, wanted: &str) -> Result<Vec<Vec<f64>>, DataError> {
        let (values, lengths) = self.cells(index)?;
        let length = lengths.first().copied().unwrap_or(0);
        if let Some(row) = lengths.iter().position(|own| *own != length) {
            let at = Place::column(self.name, index + 1, wanted);
            let what = format!(
                "row {} has {} numbers where row 1 has {length}",
                row + 1,
                lengths[row]
            );
            return Err(refused(
                at,
                what,
                "write one number for each joint in every row",
            ));
        }
        let column = |element: usize| values.iter().skip(element).step_by(length.max(1));
        Ok((0..length)
            .map(|element| column(element).copied().collect())
            .collect())
    }
}

struct Cells<'c> {
    name: &'c str,
    rows: usize,
    most: i16,
    repeats: bool,
    values: &'c mut Vec<f64>,
    lengths: &'c mut Vec<usize>,
}

impl Cells<'_> {
    fn read<T: DataType>(
        &mut self,
        mut reader: ColumnReaderImpl<T>,
        number: impl Fn(&T::T) -> f64,
    ) -> Result<(), DataError> {
        let (mut values, mut present, mut repeats) = (Vec::new(), Vec::new(), Vec::new());
        let mut done = 0;
        while done < self.rows {
            values.clear();
            present.clear();
            repeats.clear();
            let wanted = BATCH_ROWS.min(self.rows - done);
            let result =
                reader.read_records(wanted, Some(&mut present), Some(&mut repeats), &mut values);
            let (records, n_values, levels) = result.map_err(|e| damaged(self.name, &e))?;
            if records == 0 {
                let what = format!("{done} rows where {} are announced", self.rows);
                return Err(cut_short(Place::file(self.name), what));
            }
            let mut own = values.iter().take(n_values);
            let cells = if levels == 0 { n_values } else { levels };
            for cell in 0..cells {
                let is_first = !self.repeats || repeats.get(cell) == Some(&0);
                if is_first {
                    self.lengths.push(0);
                }
                let is_there = present.get(cell).is_none_or(|level| *level == self.most);
                let value = if is_there {
                    own.next().map(&number)
                } else {
                    None
                };
                // an absent number is no reading, an absent list has no numbers
                if is_there
                    || !self.repeats
                    || present.get(cell).is_some_and(|l| *l + 1 == self.most)
                {
                    self.values.push(value.unwrap_or(f64::NAN));
                    if let Some(length) = self.lengths.last_mut() {
                        *length += 1;
                    }
                }
            }
            done += records;
        }
        Ok(())
    }
}
