//! The format of a log by its first bytes: text, Parquet, MCAP.

use std::io::Read;

use crate::error::place::Place;
use crate::error::{DataError, Fault};
use crate::read::LoadedLog;
use crate::shape::LogShape;

/// How a Parquet file begins and ends.
pub(crate) const PARQUET_MAGIC: [u8; 4] = *b"PAR1";
/// How an MCAP file begins and ends.
pub(crate) const MCAP_MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";

/// What a log is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    /// Comma-separated text, plain or gzip.
    Text,
    Parquet,
    Mcap,
}

impl Format {
    /// By the first bytes.
    pub(crate) fn detect(first: &[u8]) -> Self {
        if first.starts_with(&PARQUET_MAGIC) {
            Self::Parquet
        } else if first.starts_with(&MCAP_MAGIC) {
            Self::Mcap
        } else {
            Self::Text
        }
    }

    /// Its name, and that of the feature that reads it.
    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Text => ("CSV", "default"),
            Self::Parquet => ("Parquet", "parquet"),
            Self::Mcap => ("MCAP", "mcap"),
        }
    }
}

/// Reads a log that is no text.
pub(crate) fn read_binary(
    format: Format,
    reader: impl Read,
    name: &str,
    shape: &LogShape,
) -> Result<LoadedLog, DataError> {
    match format {
        #[cfg(feature = "parquet")]
        Format::Parquet => crate::parquet_log::read(reader, name, shape),
        #[cfg(feature = "mcap")]
        Format::Mcap => {
            crate::mcap_log::read_mcap_from(reader, name, &crate::McapOptions::default(), shape)
        }
        #[allow(
            unreachable_patterns,
            reason = "a build with every feature reads them all"
        )]
        _ => {
            let _ = (reader, shape);
            let (format, feature) = format.names();
            Err(Place::file(name).error(Fault::NotBuiltIn { format, feature }))
        }
    }
}
