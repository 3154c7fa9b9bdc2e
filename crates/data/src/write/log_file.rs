//! A log that is written to its file as rows come, and appears whole or not at all.

use std::ffi::OsStr;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::GzEncoder;
use haptical_model::Recording;
use tempfile::NamedTempFile;

use crate::error::DataError;
use crate::shape::LogShape;
use crate::write::{LogWriter, unwritable};

/// Writes a log of any length to a file, gzip if the path ends in `.gz`.
///
/// The text goes to a temporary file in the same folder, which takes the path's name in
/// [`LogFile::finish`]; without that, what was at the path before is still there. Equal rows give
/// equal bytes, however they were cut into recordings.
///
/// ```
/// use haptical_data::{JointShape, LogFile, LogShape, read_log};
/// use haptical_model::Recording;
///
/// let joint = JointShape { name: "1".into(), prismatic: false, lower: -1.0, upper: 1.0 };
/// let shape = LogShape { joints: vec![joint], cable_count: 0, hands: Vec::new() };
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("log.csv.gz");
/// let chunk = Recording { joint: vec![vec![0.25, 0.5]], ..Recording::default() };
/// let mut log = LogFile::create(&path, &chunk, &shape)?;
/// log.write_rows(&chunk)?;
/// log.write_rows(&chunk)?;
/// assert!(!path.exists());
/// log.finish()?;
/// assert_eq!(read_log(&path, &shape)?.recording.joint[0], [0.25, 0.5, 0.25, 0.5]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct LogFile {
    path: PathBuf,
    writer: LogWriter<Sink>,
}

/// Where the text goes.
#[derive(Debug)]
enum Sink {
    Plain(BufWriter<NamedTempFile>),
    Gzip(Box<GzEncoder<BufWriter<NamedTempFile>>>),
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Plain(file) => file.write(bytes),
            Self::Gzip(encoder) => encoder.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Plain(file) => file.flush(),
            Self::Gzip(encoder) => encoder.flush(),
        }
    }
}

impl Sink {
    /// The file with all of the text in it.
    fn into_file(self) -> io::Result<NamedTempFile> {
        let buffer = match self {
            Self::Plain(buffer) => buffer,
            Self::Gzip(encoder) => encoder.finish()?,
        };
        buffer.into_inner().map_err(io::IntoInnerError::into_error)
    }
}

impl LogFile {
    /// Begins a log with the columns that `recording` has, and no rows yet.
    ///
    /// # Errors
    /// As [`LogWriter::new`], and [`Fault::Unwritable`](crate::Fault::Unwritable) from the file system.
    pub fn create(path: &Path, recording: &Recording, shape: &LogShape) -> Result<Self, DataError> {
        let name = path.display().to_string();
        let folder = match path.parent() {
            Some(parent) if parent != Path::new("") => parent,
            _ => Path::new("."),
        };
        let file = temporary_file(folder).map_err(|source| unwritable(&name, source))?;
        let buffer = BufWriter::new(file);
        let is_gzip = path
            .extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case("gz"));
        let sink = if is_gzip {
            // noise does not compress: the best level takes three times as long for a tenth less
            Sink::Gzip(Box::new(GzEncoder::new(buffer, Compression::fast())))
        } else {
            Sink::Plain(buffer)
        };
        Ok(Self {
            path: path.to_owned(),
            writer: LogWriter::new(sink, &name, recording, shape)?,
        })
    }

    /// Writes all rows of `recording`, which has the columns of the first one.
    ///
    /// # Errors
    /// As [`LogWriter::write_rows`].
    pub fn write_rows(&mut self, recording: &Recording) -> Result<(), DataError> {
        self.writer.write_rows(recording)
    }

    /// Ends the log and gives it its name.
    ///
    /// # Errors
    /// [`Fault::Unwritable`](crate::Fault::Unwritable) from the file system.
    pub fn finish(self) -> Result<(), DataError> {
        let name = self.path.display().to_string();
        let failed = |source| unwritable(&name, source);
        let file = self.writer.finish()?.into_file().map_err(failed)?;
        // Before the rename, so that a power cut does not leave an empty file under the name.
        file.as_file().sync_all().map_err(failed)?;
        file.persist(&self.path)
            .map_err(|error| failed(error.error))?;
        Ok(())
    }
}

/// A temporary file that gets the permissions of any new file, not those of a private one.
fn temporary_file(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(OsStr::new(".haptical-log-"));
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}
