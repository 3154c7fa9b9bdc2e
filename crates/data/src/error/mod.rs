//! Everything that can be wrong with a log, each with its place and what to do next.

pub(crate) mod kind;
pub(crate) mod near_miss;
pub(crate) mod place;
pub(crate) mod text;

use std::io;

use crate::error::near_miss::NearMiss;
use crate::error::place::Place;

/// Why a log could not be read or written.
///
/// The text of each variant says where, what, and what to do next;
/// [`kind`](DataError::kind) names the variant for programs.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DataError {
    /// There is no such file.
    #[error("{at}: no such file; check the path (relative paths start at the working directory)")]
    NotFound {
        /// The file.
        at: Box<Place>,
    },
    /// The operating system would not let the file be read.
    #[error("{at}: cannot be read ({source}); it must be a readable file, not a folder")]
    Unreadable {
        /// The file.
        at: Box<Place>,
        /// What the operating system says.
        source: io::Error,
    },
    /// The file starts as gzip but does not decompress to its end.
    #[error(fmt = text::corrupt_gzip)]
    CorruptGzip {
        /// The file.
        at: Box<Place>,
        /// What the decompressor says.
        source: io::Error,
    },
    /// The text is not UTF-8.
    #[error("{at}: byte {byte} is not UTF-8 text; {advice}")]
    NotUtf8 {
        /// Line, and column where the header is known.
        at: Box<Place>,
        /// Offset of the first such byte in the decompressed text, counted from 0.
        byte: u64,
        /// What the file probably is and what to do.
        advice: &'static str,
    },
    /// A zero byte, which no text holds.
    #[error("{at}: byte {byte} is zero (NUL), so this is not a text; {advice}")]
    NulByte {
        /// Line, and column where the header is known.
        at: Box<Place>,
        /// Offset of the first such byte in the decompressed text, counted from 0.
        byte: u64,
        /// What the file probably is and what to do.
        advice: &'static str,
    },
    /// A line that no row of a log has.
    #[error(
        "{at}: the line is longer than {mebibytes} MiB; a log has one row per line: check that \
         this file is a log, and that its line ends were not lost"
    )]
    LineTooLong {
        /// The line.
        at: Box<Place>,
        /// Longest line \[MiB\].
        mebibytes: u64,
    },
    /// Much text and no row in it.
    #[error(
        "{at}: from here on no row ends within {mebibytes} MiB; delete the blank lines, or close \
         the quotation mark that a cell opens"
    )]
    NoRow {
        /// The first line with text after the last row, or the last blank one.
        at: Box<Place>,
        /// Longest text without a row \[MiB\].
        mebibytes: u64,
    },
    /// More columns than a log has.
    #[error(
        "{at}: {columns} columns, at most {most} are read; check that the header stands on a line \
         of its own, and leave out columns that are not needed"
    )]
    TooManyColumns {
        /// The header's line.
        at: Box<Place>,
        /// Columns found.
        columns: usize,
        /// Columns allowed.
        most: usize,
    },
    /// More readings than are kept in memory.
    #[error(
        "{at}: the {rows} rows so far fill {gibibytes} GiB of memory, the most that is used; keep \
         every n-th row, leave out columns that are not needed, or split the log"
    )]
    TooLarge {
        /// The first row that does not fit.
        at: Box<Place>,
        /// Rows up to there.
        rows: usize,
        /// Memory allowed \[GiB\].
        gibibytes: u64,
    },
    /// A name of a contact or a plane that is no name.
    #[error(
        "{at}: a name of {bytes} bytes, at most {most} are read; name what is touched by a short \
         word or a number"
    )]
    LongId {
        /// The cell.
        at: Box<Place>,
        /// Length of the name \[bytes\].
        bytes: usize,
        /// Length allowed \[bytes\].
        most: usize,
    },
    /// A binary file that is read only with a feature that this build lacks.
    #[error(
        "{at}: {format} data, which this build does not read; build haptical with `--features \
         {feature}`, or save the log as CSV"
    )]
    NotBuiltIn {
        /// The file.
        at: Box<Place>,
        /// What the file is.
        format: &'static str,
        /// Name of the feature.
        feature: &'static str,
    },
    /// A binary file that does not hold together.
    #[error(
        "{at}: the {format} data is damaged or cut off ({what}); copy or record the file again"
    )]
    Damaged {
        /// The file.
        at: Box<Place>,
        /// What the file is.
        format: &'static str,
        /// What does not fit.
        what: String,
    },
    /// A binary file or a table in memory that is sound but no log.
    #[error("{at}: {what}; {advice}")]
    NotALog {
        /// The file, and the column where it is known.
        at: Box<Place>,
        /// What stands in the way.
        what: String,
        /// What to do.
        advice: String,
    },
    /// The cells are not separated by commas.
    #[error(
        "{at}: the cells are separated by {saw}; a log is separated by commas, with a point as \
         decimal sign: export it again so"
    )]
    WrongSeparator {
        /// The header's line.
        at: Box<Place>,
        /// The separator that was seen, in words.
        saw: &'static str,
    },
    /// The first line with text is not a header, or there is none.
    #[error(fmt = text::no_header)]
    NoHeader {
        /// The line; line 1 of an empty file.
        at: Box<Place>,
        /// First cell found instead, empty if there is none.
        found: String,
    },
    /// Two columns have one name.
    #[error("{at}: column {first} has this name already; rename or delete one of the two")]
    DuplicateColumn {
        /// The later column.
        at: Box<Place>,
        /// Number of the earlier column, counted from 1.
        first: usize,
    },
    /// A joint of the device has no column of readings.
    #[error(fmt = text::missing_column)]
    MissingColumn {
        /// The header's line and the first missing column.
        at: Box<Place>,
        /// The missing columns.
        missing: Vec<String>,
        /// All joint columns that the device requires.
        required: Vec<String>,
        /// Columns that may be the missing ones under another name or unit.
        near_misses: Vec<NearMiss>,
    },
    /// A joint column carries a unit that does not belong to this type of joint.
    #[error(fmt = text::wrong_unit)]
    WrongUnit {
        /// The column.
        at: Box<Place>,
        /// Name of the joint in the device file.
        joint: String,
        /// Whether the device file says that the joint is prismatic.
        prismatic: bool,
        /// Name that the column should have.
        expected: String,
    },
    /// Some columns of a vector or quaternion are there and some are not.
    #[error(fmt = text::incomplete_group)]
    IncompleteGroup {
        /// The header's line and the first column that is there.
        at: Box<Place>,
        /// Columns that are there.
        present: Vec<String>,
        /// Columns that are not.
        missing: Vec<String>,
    },
    /// There is a header and nothing below it.
    #[error("{at}: no rows below the header; record at least 2 rows")]
    NoRows {
        /// The header's line.
        at: Box<Place>,
    },
    /// There are too few rows.
    #[error("{at}: only {rows} row; record at least 2 rows")]
    TooFewRows {
        /// The last row.
        at: Box<Place>,
        /// Number of rows.
        rows: usize,
    },
    /// A row has more or fewer cells than the header.
    #[error("{at}: {got} cells where the header has {expected}; {advice}")]
    CellCount {
        /// The row.
        at: Box<Place>,
        /// Number of cells in the row.
        got: usize,
        /// Number of cells in the header.
        expected: usize,
        /// What it probably is and what to do.
        advice: &'static str,
    },
    /// A cell contains a line break, so a quotation mark was opened and not closed.
    #[error("{at}: a quotation mark opens here and is not closed on this line; close or delete it")]
    UnclosedQuote {
        /// The cell.
        at: Box<Place>,
    },
    /// Text where a number is needed.
    #[error(
        "{at}: expected a number, found `{found}`; correct it, or leave the cell empty where \
         there is no reading"
    )]
    NotANumber {
        /// The cell.
        at: Box<Place>,
        /// The text, shortened.
        found: String,
    },
    /// A number with a comma as decimal sign.
    #[error(
        "{at}: expected a number, found `{found}`; the decimal sign must be a point: export the \
         log again so"
    )]
    DecimalComma {
        /// The cell.
        at: Box<Place>,
        /// The text.
        found: String,
    },
    /// Not-a-number or infinity written in a cell.
    #[error(
        "{at}: `{found}` is not a finite number; leave the cell empty where there is no reading"
    )]
    NotFinite {
        /// The cell.
        at: Box<Place>,
        /// The text.
        found: String,
    },
    /// A reading that no device has.
    #[error(
        "{at}: `{found}` is beyond what any device measures, {largest:e} in SI units; correct it, \
         or leave the cell empty where there is no reading"
    )]
    ReadingTooLarge {
        /// The cell.
        at: Box<Place>,
        /// The text, shortened.
        found: String,
        /// Largest reading.
        largest: f64,
    },
    /// An empty cell in a column that each row needs.
    #[error("{at}: empty, but each row needs this reading; fill it in or delete the row")]
    MissingReading {
        /// The cell.
        at: Box<Place>,
    },
    /// Time stands still or runs backwards within a run.
    #[error(
        "{at}: time {time_s} s does not come after {previous_s} s of line {previous_line}; sort \
         the rows by time, delete repeated ones, or give each recording its own number in a column `run`"
    )]
    TimeOrder {
        /// The later row.
        at: Box<Place>,
        /// Its time \[s\].
        time_s: f64,
        /// Line of the row before.
        previous_line: u64,
        /// Time of the row before \[s\].
        previous_s: f64,
    },
    /// A run's number is not an integer, or is empty.
    #[error(
        "{at}: a run is numbered by an integer in each row, found `{found}`; write a whole number"
    )]
    RunNotInteger {
        /// The cell.
        at: Box<Place>,
        /// The text.
        found: String,
    },
    /// A run continues after another run has begun.
    #[error(
        "{at}: run {run} continues here, but it ended at line {previous_line}; put the rows of a \
         run next to each other or give them different numbers"
    )]
    RunNotContiguous {
        /// Where the run continues.
        at: Box<Place>,
        /// The run.
        run: i64,
        /// Last line of the run's earlier rows.
        previous_line: u64,
    },
    /// All four parts of an orientation are zero.
    #[error("{at}: the quaternion is zero; leave the four cells empty where there is no reading")]
    ZeroQuaternion {
        /// The row, and the column `qw`.
        at: Box<Place>,
    },
    /// An orientation is no unit quaternion.
    #[error(
        "{at}: the quaternion has norm {norm}, which must be 1 within {allowed}; check the four \
         columns qw, qx, qy, qz and their number of digits"
    )]
    QuaternionNorm {
        /// The row, and the column `qw`.
        at: Box<Place>,
        /// Its norm.
        norm: f64,
        /// Allowed deviation of the norm from 1.
        allowed: f64,
    },
    /// A distance below zero.
    #[error(
        "{at}: distance {value_m} m is negative; the column holds the distance from the cable's \
         exit to the handle: add the distance at the encoder's zero, or correct its direction"
    )]
    NegativeDistance {
        /// The cell.
        at: Box<Place>,
        /// The distance \[m\].
        value_m: f64,
    },
    /// Readings far outside the joint's limits that would fit as degrees.
    #[error(
        "{at}: looks like degrees: the readings go from {min} to {max}, the device's limits from \
         {lower_rad} to {upper_rad} rad; multiply the column by pi/180 ({}if it holds motor angles, \
         divide by the transmission ratio; if the joint does turn so far, widen its limits)",
        turns(*.within_a_turn)
    )]
    LooksLikeDegrees {
        /// The column, and the line of the reading farthest from zero.
        at: Box<Place>,
        /// Smallest reading.
        min: f64,
        /// Largest reading.
        max: f64,
        /// Lower limit of the joint \[rad\].
        lower_rad: f64,
        /// Upper limit of the joint \[rad\].
        upper_rad: f64,
        /// Whether no reading is farther beyond the limits than a whole turn: it may be that alone.
        within_a_turn: bool,
    },
    /// The shape describes no device.
    #[error("{at}: a log cannot be matched to a device without joints; correct the device file")]
    InvalidShape {
        /// The file.
        at: Box<Place>,
    },
    /// A recording in memory that cannot be written as a log.
    #[error("{at}: the recording cannot be written: {what}")]
    InvalidRecording {
        /// The file, and the line and column that would hold it.
        at: Box<Place>,
        /// What is wrong and what would be right.
        what: String,
    },
    /// The operating system would not let the file be written.
    #[error("{at}: cannot be written ({source}); check that the folder exists and has room")]
    Unwritable {
        /// The file.
        at: Box<Place>,
        /// What the operating system says.
        source: io::Error,
    },
}

fn turns(within_a_turn: bool) -> &'static str {
    if within_a_turn {
        "if some rows alone are a whole turn off, take 2 pi off them instead; "
    } else {
        ""
    }
}
