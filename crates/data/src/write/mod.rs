//! Recordings to the rows of a log, as they come.

pub(crate) mod column;
pub(crate) mod log_file;
pub(crate) mod whole;

use std::io::{self, Write};

use haptical_model::Recording;

use crate::error::place::Place;
use crate::error::{DataError, Fault};
use crate::shape::LogShape;
use crate::write::column::{WriteColumn, check_covariate_names, columns_of};

/// Writes a log row by row: the header from a first recording's columns, then the rows of this
/// and further recordings with the same columns.
///
/// Numbers are written with the fewest digits that read back to the same number. What the
/// measurements mean is not checked: times that run backwards are written, and refused by
/// [`read_log`](crate::read_log).
///
/// ```
/// use haptical_data::{JointShape, LogShape, LogWriter};
/// use haptical_model::Recording;
///
/// let joint = JointShape { name: "1".into(), prismatic: true, lower: 0.0, upper: 1.0 };
/// let shape = LogShape { joints: vec![joint], cable_count: 0, hands: Vec::new() };
/// let chunk = Recording { joint: vec![vec![0.25, 0.5]], ..Recording::default() };
/// let mut writer = LogWriter::new(Vec::new(), "log.csv", &chunk, &shape)?;
/// writer.write_rows(&chunk)?;
/// assert_eq!(writer.finish()?, b"theta1_m\n0.25\n0.5\n");
/// # Ok::<(), haptical_data::DataError>(())
/// ```
#[derive(Debug)]
pub struct LogWriter<W: Write> {
    name: String,
    header: Vec<String>,
    shape: LogShape,
    n_rows: u64,
    output: csv::Writer<W>,
}

impl<W: Write> LogWriter<W> {
    /// Writes the header with the columns that `recording` has, and no rows yet; errors call the
    /// log `name`.
    ///
    /// # Errors
    /// [`Fault::InvalidShape`](crate::Fault::InvalidShape) for a device without joints, [`Fault::InvalidRecording`]
    /// when the recording does not fit the shape or a covariate's name cannot be a header,
    /// [`Fault::Unwritable`](crate::Fault::Unwritable) from the writer.
    pub fn new(
        writer: W,
        name: &str,
        recording: &Recording,
        shape: &LogShape,
    ) -> Result<Self, DataError> {
        shape.check(name)?;
        let columns = columns_of(recording, shape, name)?;
        check_covariate_names(&columns, recording.covariates.len(), shape, name)?;
        let header: Vec<String> = columns.into_iter().map(|column| column.name).collect();
        let mut output = csv::Writer::from_writer(writer);
        output
            .write_record(&header)
            .map_err(|error| unwritable(name, error.into()))?;
        Ok(Self {
            name: name.to_owned(),
            header,
            shape: shape.clone(),
            n_rows: 0,
            output,
        })
    }

    /// Writes all rows of `recording`, which has the columns of the first one.
    ///
    /// # Errors
    /// [`Fault::InvalidRecording`](crate::Fault::InvalidRecording) for other columns, columns of unequal length, a joint
    /// reading that is missing, a number that is infinite, or a text with a line break or with
    /// blanks at its ends; [`Fault::Unwritable`](crate::Fault::Unwritable) from the writer. Rows before the faulty one
    /// are written.
    pub fn write_rows(&mut self, recording: &Recording) -> Result<(), DataError> {
        let columns = columns_of(recording, &self.shape, &self.name)?;
        self.check_columns(&columns, recording.len())?;
        let mut cell = String::new();
        for row in 0..recording.len() {
            for (index, column) in columns.iter().enumerate() {
                cell.clear();
                column.print(row, &mut cell).map_err(|what| {
                    // The header is line 1, the first row line 2.
                    Place::cell(&self.name, self.n_rows + 2, index + 1, &column.name).error(
                        Fault::InvalidRecording {
                            what: what.to_owned(),
                        },
                    )
                })?;
                self.output
                    .write_field(&cell)
                    .map_err(|e| unwritable(&self.name, e.into()))?;
            }
            self.output
                .write_record(None::<&[u8]>)
                .map_err(|error| unwritable(&self.name, error.into()))?;
            self.n_rows += 1;
        }
        Ok(())
    }

    /// Flushes and gives back the writer.
    ///
    /// # Errors
    /// [`Fault::Unwritable`](crate::Fault::Unwritable) from the writer.
    pub fn finish(self) -> Result<W, DataError> {
        let Self { name, output, .. } = self;
        output
            .into_inner()
            .map_err(|error| unwritable(&name, error.into_error()))
    }

    fn check_columns(&self, columns: &[WriteColumn<'_>], n_rows: usize) -> Result<(), DataError> {
        if !columns.iter().map(|column| &column.name).eq(&self.header) {
            let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
            let (header, names) = (self.header.join(","), names.join(","));
            let what = format!(
                "the header is `{header}`, these rows have `{names}`; write them to another log"
            );
            return Err(Place::file(&self.name).error(Fault::InvalidRecording { what }));
        }
        let unequal = columns
            .iter()
            .enumerate()
            .find(|(_, column)| column.cells.len() != n_rows);
        let Some((index, column)) = unequal else {
            return Ok(());
        };
        let at = Place::column(&self.name, index + 1, &column.name);
        let what = format!(
            "the column has {} rows and the first joint {n_rows}; give all columns the same",
            column.cells.len()
        );
        Err(at.error(Fault::InvalidRecording { what }))
    }
}

/// The error for what the operating system refused.
pub(crate) fn unwritable(name: &str, source: io::Error) -> DataError {
    // Without the name of the temporary file, which nobody has heard of.
    let inner = source.get_ref().and_then(|inner| inner.source());
    let inner = inner.and_then(|inner| inner.downcast_ref::<io::Error>());
    let code = inner.and_then(io::Error::raw_os_error);
    Place::file(name).error(Fault::Unwritable {
        source: code.map_or(source, io::Error::from_raw_os_error),
    })
}
