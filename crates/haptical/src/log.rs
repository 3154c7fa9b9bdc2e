//! Logs of a device, with the warnings and the hash of the file that they came from.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use haptical_calibration::check_reach;
use haptical_data::{Cells, LoadedLog, LogShape, log_from_columns, read_log, read_log_from};
use haptical_model::Recording;

use crate::device::Device;
use crate::error::Error;
use crate::files::{Fingerprint, HashingReader, InputFile, Source};

/// A recording of a device.
#[derive(Debug, Clone)]
pub struct Log {
    /// Its rows.
    pub recording: Arc<Recording>,
    /// What is odd about it.
    pub warnings: Vec<String>,
    source: Source,
    fingerprint: Option<Fingerprint>,
}

impl Log {
    /// Reads a log of a device: CSV or JSON lines, plain or gzip; with cargo features Parquet and bags of ROS 2.
    ///
    /// # Errors
    /// A file that cannot be read or is no log of this device, with line and column; distances in millimetres.
    pub fn read(path: impl AsRef<Path>, device: &Device) -> Result<Self, Error> {
        Self::open(&Source::given(path.as_ref()), device)
    }

    /// Reads a log, once: it may be a pipe.
    ///
    /// # Errors
    /// As [`Log::read`].
    pub fn open(source: &Source, device: &Device) -> Result<Self, Error> {
        let shape = LogShape::from(&device.model);
        let file = match File::open(&source.path) {
            Ok(file) if !source.path.is_dir() => file,
            // says what is wrong with it
            _ => {
                let refused = read_log(&source.path, &shape).err();
                let was_there = || Error::internal("the log was there a moment later");
                return Err(refused.map_or_else(was_there, Error::from));
            }
        };
        let mut reader = HashingReader::new(file);
        let log = read_log_from(&mut reader, &source.name(), &shape);
        let log = log.map_err(|error| Error::log(error, device))?;
        // The log was read without error, but its end may not have been asked for.
        let _ = std::io::copy(&mut reader, &mut std::io::sink());
        Self::new(log, source.clone(), Some(reader.fingerprint()), device)
    }

    /// Reads a log from a text that was read from a file.
    ///
    /// # Errors
    /// As [`Log::read`].
    pub(crate) fn from_text(text: &str, source: &Source, device: &Device) -> Result<Self, Error> {
        let shape = LogShape::from(&device.model);
        let log = read_log_from(text.as_bytes(), &source.name(), &shape);
        let log = log.map_err(|error| Error::log(error, device))?;
        let fingerprint = source.fingerprint_text(text);
        Self::new(log, source.clone(), Some(fingerprint), device)
    }

    /// Takes a log from columns in memory, by their names in a file; messages call the file by `name`.
    ///
    /// # Errors
    /// As [`Log::read`].
    pub fn from_columns(
        columns: &[(&str, Cells<'_>)],
        name: &str,
        device: &Device,
    ) -> Result<Self, Error> {
        let shape = LogShape::from(&device.model);
        let log = log_from_columns(columns, name, &shape);
        let log = log.map_err(|error| Error::log(error, device))?;
        Self::new(log, Source::text("", name), None, device)
    }

    /// Takes rows in memory, such as a simulated recording; messages call the file by `name`.
    ///
    /// # Errors
    /// Distances in millimetres.
    pub fn from_recording(
        recording: Recording,
        name: &str,
        device: &Device,
    ) -> Result<Self, Error> {
        let log = LoadedLog {
            recording,
            warnings: Vec::new(),
        };
        Self::new(log, Source::text("", name), None, device)
    }

    fn new(
        mut log: LoadedLog,
        source: Source,
        fingerprint: Option<Fingerprint>,
        device: &Device,
    ) -> Result<Self, Error> {
        check_reach(&device.model, &log.recording)
            .map_err(|error| Error::calibration(&error, &source.path, &source.path))?;
        source.relabel(&mut log.warnings);
        Ok(Self {
            recording: Arc::new(log.recording),
            warnings: log.warnings,
            source,
            fingerprint,
        })
    }

    /// Its bytes once more, as they were read; none of columns in memory.
    ///
    /// # Errors
    /// It is no file that can be read twice, or it was changed since.
    pub(crate) fn read_again(&self) -> Result<Option<Vec<u8>>, Error> {
        let Some(before) = &self.fingerprint else {
            return Ok(None);
        };
        let path = &self.source.path;
        if !path.is_file() {
            let said = "it cannot be read twice, as a repair must; give a file, not a pipe";
            return Err(Error::of_file("no-file", said, path));
        }
        let unreadable = |error| Error::unreadable(&error, path, "check its permissions");
        let bytes = std::fs::read(path).map_err(unreadable)?;
        if Fingerprint::from_bytes(&bytes) != *before {
            let said = "it was changed while it was diagnosed; run the command again";
            return Err(Error::of_file("changed", said, path));
        }
        Ok(Some(bytes))
    }

    /// The same log with other rows: several recordings as one, or one without copies.
    pub(crate) fn with_recording(&self, recording: Recording) -> Self {
        Self {
            recording: Arc::new(recording),
            ..self.clone()
        }
    }

    /// A refusal of a row.
    pub(crate) fn refuse_row(
        &self,
        name: &'static str,
        what: impl Into<String>,
        row: usize,
        next: &str,
    ) -> Error {
        let line = self.recording.line.get(row).copied();
        Error::log_line(name, what, &self.source.path, line, next)
    }

    /// Its origin.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// The file that it was read from, given by `flag`; none for columns in memory.
    pub fn input(&self, flag: &str) -> Option<InputFile> {
        let fingerprint = self.fingerprint.clone()?;
        Some(self.source.input(flag, fingerprint))
    }
}
