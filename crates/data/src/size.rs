//! Limits on the size of a log, so that no file fills the memory or takes for ever.

/// Longest line \[bytes\]: a row of 4096 numbers with all their digits has a tenth of it.
pub(crate) const LONGEST_LINE_BYTES: u64 = 1 << 20;

/// Longest text without a row \[bytes\]: blank lines, or a cell whose quotation mark is not closed.
/// Above the longest line by more than a reader's buffer.
pub(crate) const LONGEST_GAP_BYTES: u64 = 2 << 20;

/// Most columns.
pub const MOST_COLUMNS: usize = 4096;

/// Most memory for what is read \[bytes\]: 10 million rows of 50 columns fit. The size of the file
/// is not limited, nor how far it was compressed: a device at rest compresses a thousandfold.
pub const MOST_MEMORY_BYTES: u64 = 4 << 30;

/// Longest name of a contact or a plane \[bytes\].
pub(crate) const LONGEST_ID_BYTES: usize = 256;

/// Largest reading of an angle, a length, a torque or a force in SI units: its square and the sum
/// of many squares are far from the largest number.
pub(crate) const LARGEST_READING: f64 = 1e12;

/// Memory of a number, a line number, or an empty text \[bytes\].
pub(crate) const NUMBER_BYTES: u64 = 8;
/// See [`NUMBER_BYTES`].
pub(crate) const TEXT_BYTES: u64 = size_of::<String>() as u64;
