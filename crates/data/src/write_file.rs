//! A recording to a file that appears whole or not at all.

use std::ffi::OsStr;
use std::io::{BufWriter, Write};
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;
use haptical_model::Recording;

use crate::error::DataError;
use crate::shape::LogShape;
use crate::write::{LogWriter, unwritable};

/// Writes a log, gzip if the path ends in `.gz`.
///
/// The text goes to a temporary file in the same folder, which then takes the path's name; after
/// an error, what was at the path before is still there. Equal recordings give equal bytes.
///
/// # Errors
/// [`DataError::InvalidRecording`] and [`DataError::InvalidShape`] as [`LogWriter`];
/// [`DataError::Unwritable`] from the file system.
pub fn write_log(path: &Path, recording: &Recording, shape: &LogShape) -> Result<(), DataError> {
    let name = path.display().to_string();
    let failed = |source| unwritable(&name, source);
    let folder = match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    let mut file = temporary_file(folder).map_err(failed)?;
    let is_gzip = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("gz"));
    if is_gzip {
        let encoder = GzEncoder::new(BufWriter::new(file.as_file_mut()), Compression::default());
        let encoder = write_named(encoder, &name, recording, shape)?;
        encoder
            .finish()
            .and_then(|mut buffer| buffer.flush())
            .map_err(failed)?;
    } else {
        write_named(file.as_file_mut(), &name, recording, shape)?;
    }
    // Before the rename, so that a power cut does not leave an empty file under the name.
    file.as_file().sync_all().map_err(failed)?;
    file.persist(path).map_err(|error| failed(error.error))?;
    Ok(())
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
    write_named(writer, "log", recording, shape)?;
    Ok(())
}

fn write_named<W: Write>(
    writer: W,
    name: &str,
    recording: &Recording,
    shape: &LogShape,
) -> Result<W, DataError> {
    let mut log = LogWriter::new(writer, name, recording, shape)?;
    log.write_rows(recording)?;
    log.finish()
}

/// A temporary file that gets the permissions of any new file, not those of a private one.
fn temporary_file(folder: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(OsStr::new(".haptical-log-"));
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}
