//! The names of faults, for programs.

use crate::error::Fault;

impl Fault {
    /// Name, which stays the same between releases.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::NotFound { .. } => "not-found",
            Self::Unreadable { .. } => "unreadable",
            Self::CorruptGzip { .. } => "corrupt-gzip",
            Self::NotUtf8 { .. } => "not-utf8",
            Self::NulByte { .. } => "nul-byte",
            Self::LineTooLong { .. } => "line-too-long",
            Self::NoRow { .. } => "no-row",
            Self::TooManyColumns { .. } | Self::TooManyKeys { .. } => "too-many-columns",
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
            Self::HandColumn => "hand-column",
            Self::NoHandColumn { .. } => "no-hand-column",
            Self::UnknownHand { .. } => "unknown-hand",
            Self::NegativeDistance { .. } => "negative-distance",
            Self::LooksLikeDegrees { .. } => "looks-like-degrees",
            Self::LooksLikeCounts { .. } => "looks-like-counts",
            Self::InvalidShape { .. } => "invalid-shape",
            Self::InvalidRecording { .. } => "invalid-recording",
            Self::Unwritable { .. } => "unwritable",
        }
    }
}
