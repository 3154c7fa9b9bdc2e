//! A whole recording to a file or to a writer.

use std::io::Write;
use std::path::Path;

use haptical_model::Recording;

use crate::error::DataError;
use crate::shape::LogShape;
use crate::write::LogWriter;
use crate::write::log_file::LogFile;

/// Writes a log, gzip if the path ends in `.gz`.
///
/// The file appears whole or not at all, as with [`LogFile`]; after an error, what was at the path
/// before is still there. Equal recordings give equal bytes.
///
/// # Errors
/// [`Fault::InvalidRecording`](crate::Fault::InvalidRecording) and
/// [`Fault::InvalidShape`](crate::Fault::InvalidShape) as [`LogWriter`];
/// [`Fault::Unwritable`](crate::Fault::Unwritable) from the file system.
pub fn write_log(path: &Path, recording: &Recording, shape: &LogShape) -> Result<(), DataError> {
    let mut log = LogFile::create(path, recording, shape)?;
    log.write_rows(recording)?;
    log.finish()
}

/// Writes a log as plain text.
///
/// # Errors
/// As [`LogWriter`].
pub fn write_log_to(
    writer: impl Write,
    recording: &Recording,
    shape: &LogShape,
) -> Result<(), DataError> {
    let mut log = LogWriter::new(writer, "log", recording, shape)?;
    log.write_rows(recording)?;
    log.finish()?;
    Ok(())
}
