//! The format of a log by its first bytes: text, JSON lines, Parquet, MCAP, SQLite.

use std::io::Read;

use crate::error::place::Place;
use crate::error::{DataError, Fault};
use crate::read::LoadedLog;
use crate::shape::LogShape;

/// How a Parquet file begins and ends.
pub(crate) const PARQUET_MAGIC: [u8; 4] = *b"PAR1";
/// How an MCAP file begins and ends.
pub(crate) const MCAP_MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";

/// How an SQLite file begins, as bags of ROS 2 are.
pub(crate) const SQLITE_MAGIC: [u8; 16] = *b"SQLite format 3\0";

/// What a log is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    /// Comma-separated text, plain or gzip.
    Text,
    /// An object of JSON in each line; gzip is seen later.
    JsonLines,
    Parquet,
    Mcap,
    Sqlite,
}

impl Format {
    /// By the first bytes.
    pub(crate) fn detect(first: &[u8]) -> Self {
        if first.starts_with(&PARQUET_MAGIC) {
            Self::Parquet
        } else if first.starts_with(&MCAP_MAGIC) {
            Self::Mcap
        } else if first.starts_with(&SQLITE_MAGIC) {
            Self::Sqlite
        } else if is_json(first) {
            Self::JsonLines
        } else {
            Self::Text
        }
    }

    /// Its name, and that of the feature that reads it.
    pub(crate) fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Text => ("CSV", "default"),
            Self::JsonLines => ("JSON lines", "default"),
            Self::Parquet => ("Parquet", "parquet"),
            Self::Mcap => ("MCAP", "mcap"),
            Self::Sqlite => ("SQLite", "rosbag2"),
        }
    }

    /// The error that this build lacks it.
    pub(crate) fn not_built_in(self, name: &str) -> DataError {
        let (format, feature) = self.names();
        Place::file(name).error(Fault::NotBuiltIn { format, feature })
    }
}

/// Whether a text is one of JSON objects: no header of a table begins so.
pub(crate) fn is_json(first: &[u8]) -> bool {
    first.trim_ascii_start().first() == Some(&b'{')
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
            crate::ros::read_bag_from(reader, name, &crate::BagOptions::default(), shape)
        }
        #[cfg(feature = "rosbag2")]
        Format::Sqlite => {
            crate::ros::read_bag_from(reader, name, &crate::BagOptions::default(), shape)
        }
        _ => {
            let _ = (reader, shape);
            Err(format.not_built_in(name))
        }
    }
}
