//! The place and the kind of an error, for programs.

use crate::error::DataError;
use crate::error::place::Place;

impl DataError {
    /// Where it is.
    pub fn place(&self) -> &Place {
        match self {
            Self::NotFound { at }
            | Self::Unreadable { at, .. }
            | Self::CorruptGzip { at, .. }
            | Self::NotUtf8 { at, .. }
            | Self::NulByte { at, .. }
            | Self::LineTooLong { at, .. }
            | Self::NoRow { at, .. }
            | Self::TooManyColumns { at, .. }
            | Self::TooLarge { at, .. }
            | Self::LongId { at, .. }
            | Self::NotBuiltIn { at, .. }
            | Self::Damaged { at, .. }
            | Self::NotALog { at, .. }
            | Self::WrongSeparator { at, .. }
            | Self::NoHeader { at, .. }
            | Self::DuplicateColumn { at, .. }
            | Self::MissingColumn { at, .. }
            | Self::WrongUnit { at, .. }
            | Self::IncompleteGroup { at, .. }
            | Self::NoRows { at }
            | Self::TooFewRows { at, .. }
            | Self::CellCount { at, .. }
            | Self::UnclosedQuote { at }
            | Self::NotANumber { at, .. }
            | Self::DecimalComma { at, .. }
            | Self::NotFinite { at, .. }
            | Self::ReadingTooLarge { at, .. }
            | Self::MissingReading { at }
            | Self::TimeOrder { at, .. }
            | Self::RunNotInteger { at, .. }
            | Self::RunNotContiguous { at, .. }
            | Self::ZeroQuaternion { at }
            | Self::QuaternionNorm { at, .. }
            | Self::NegativeDistance { at, .. }
            | Self::LooksLikeDegrees { at, .. }
            | Self::InvalidShape { at }
            | Self::InvalidRecording { at, .. }
            | Self::Unwritable { at, .. } => at,
        }
    }

    /// Line of the file, counted from 1, where it is known.
    pub fn line(&self) -> Option<u64> {
        self.place().line
    }

    /// Name of the column, where it is known.
    pub fn column(&self) -> Option<&str> {
        self.place().column.as_deref()
    }

    /// Position of the column in the header, counted from 1, where it is known.
    pub fn column_number(&self) -> Option<usize> {
        self.place().column_number
    }

    /// Name of the variant, which stays the same between releases.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::NotFound { .. } => "not-found",
            Self::Unreadable { .. } => "unreadable",
            Self::CorruptGzip { .. } => "corrupt-gzip",
            Self::NotUtf8 { .. } => "not-utf8",
            Self::NulByte { .. } => "nul-byte",
            Self::LineTooLong { .. } => "line-too-long",
            Self::NoRow { .. } => "no-row",
            Self::TooManyColumns { .. } => "too-many-columns",
            Self::TooLarge { .. } => "too-large",
            Self::LongId { .. } => "long-id",
            Self::NotBuiltIn { .. } => "not-built-in",
            Self::Damaged { .. } => "damaged",
            Self::NotALog { .. } => "not-a-log",
            Self::WrongSeparator { .. } => "wrong-separator",
            Self::NoHeader { .. } => "no-header",
            Self::DuplicateColumn { .. } => "duplicate-column",
            Self::MissingColumn { .. } => "missing-column",
            Self::WrongUnit { .. } => "wrong-unit",
            Self::IncompleteGroup { .. } => "incomplete-group",
            Self::NoRows { .. } => "no-rows",
            Self::TooFewRows { .. } => "too-few-rows",
            Self::CellCount { .. } => "cell-count",
            Self::UnclosedQuote { .. } => "unclosed-quote",
            Self::NotANumber { .. } => "not-a-number",
            Self::DecimalComma { .. } => "decimal-comma",
            Self::NotFinite { .. } => "not-finite",
            Self::ReadingTooLarge { .. } => "reading-too-large",
            Self::MissingReading { .. } => "missing-reading",
            Self::TimeOrder { .. } => "time-order",
            Self::RunNotInteger { .. } => "run-not-integer",
            Self::RunNotContiguous { .. } => "run-not-contiguous",
            Self::ZeroQuaternion { .. } => "zero-quaternion",
            Self::QuaternionNorm { .. } => "quaternion-norm",
            Self::NegativeDistance { .. } => "negative-distance",
            Self::LooksLikeDegrees { .. } => "looks-like-degrees",
            Self::InvalidShape { .. } => "invalid-shape",
            Self::InvalidRecording { .. } => "invalid-recording",
            Self::Unwritable { .. } => "unwritable",
        }
    }
}
