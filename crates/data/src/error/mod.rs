//! Faults of a log, each with its place and what to do next.

pub(crate) mod kind;
pub(crate) mod near_miss;
pub(crate) mod place;
pub(crate) mod text;

use std::io;

use crate::error::near_miss::NearMiss;
use crate::error::place::Place;

/// Why a log could not be read or written: what is wrong, and its place in the log.
///
/// The text says where, what, and what to do next.
#[derive(Debug)]
pub struct DataError {
    /// The place.
    pub at: Box<Place>,
    /// What is wrong there.
    pub fault: Fault,
}

impl DataError {
    /// Name of the fault, which stays the same between releases.
    pub fn kind(&self) -> &'static str {
        self.fault.kind()
    }

    /// Line of the file, counted from 1, where it is known.
    pub fn line(&self) -> Option<u64> {
        self.at.line
    }

    /// Name of the column, where it is known.
    pub fn column(&self) -> Option<&str> {
        self.at.column.as_deref()
    }

    /// Position of the column in the header, counted from 1, where it is known.
    pub fn column_number(&self) -> Option<usize> {
        self.at.column_number
    }
}

impl std::fmt::Display for DataError {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(to, "{}: {}", self.at, self.fault)
    }
}

impl std::error::Error for DataError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.fault.source()
    }
}

impl Place {
    /// The error that something is wrong here.
    pub(crate) fn error(self: Box<Self>, fault: Fault) -> DataError {
        DataError { at: self, fault }
    }
}

/// Everything that can be wrong with a log.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// There is no such file.
    #[error("no such file; check the path (relative paths start at the working directory)")]
    NotFound,
    /// The operating system would not let the file be read.
    #[error("cannot be read ({source}); it must be a readable file, not a folder")]
    Unreadable {
        /// What the operating system says.
        source: io::Error,
    },
    /// The file starts as gzip but does not decompress to its end.
    #[error(fmt = text::corrupt_gzip)]
    CorruptGzip {
        /// What the decompressor says.
        source: io::Error,
    },
    /// The text is not UTF-8.
    #[error("byte {byte} is not UTF-8 text; {advice}")]
    NotUtf8 {
        /// Offset of the first such byte in the decompressed text, counted from 0.
        byte: u64,
        /// What the file probably is and what to do.
        advice: &'static str,
    },
    /// A zero byte, which no text holds.
    #[error("byte {byte} is zero (NUL), so this is not a text; {advice}")]
    NulByte {
        /// Offset of the first such byte in the decompressed text, counted from 0.
        byte: u64,
        /// What the file probably is and what to do.
        advice: &'static str,
    },
    /// A line that no row of a log has.
    #[error(
        "the line is longer than {mebibytes} MiB; a log has one row per line: check that \
         this file is a log, and that its line ends were not lost"
    )]
    LineTooLong {
        /// Longest line \[MiB\].
        mebibytes: u64,
    },
    /// Much text and no row in it.
    #[error(
        "from here on no row ends within {mebibytes} MiB; delete the blank lines, or close \
         the quotation mark that a cell opens"
    )]
    NoRow {
        /// Longest text without a row \[MiB\].
        mebibytes: u64,
    },
    /// More columns than a log has.
    #[error(
        "{columns} columns, at most {most} are read; check that the header is on a line \
         of its own, and leave out columns that are not needed"
    )]
    TooManyColumns {
        /// Columns found.
        columns: usize,
        /// Columns allowed.
        most: usize,
    },
    /// More different keys in lines of JSON than a log has columns.
    #[error(
        "the lines so far have more than {most} different keys, and each key is a column; leave out \
         keys that are not needed"
    )]
    TooManyKeys {
        /// Keys allowed.
        most: usize,
    },
    /// More readings than are kept in memory.
    #[error(
        "the {rows} rows so far fill {gibibytes} GiB of memory, the most that is used; keep \
         every n-th row, leave out columns that are not needed, or split the log"
    )]
    TooLarge {
        /// Rows up to there.
        rows: usize,
        /// Memory allowed \[GiB\].
        gibibytes: u64,
    },
    /// A name of a contact or a plane that is no name.
    #[error(
        "a name of {bytes} bytes, at most {most} are read; name what is touched by a short \
         word or a number"
    )]
    LongId {
        /// Length of the name \[bytes\].
        bytes: usize,
        /// Length allowed \[bytes\].
        most: usize,
    },
    /// A binary file that is read only with a feature that this build lacks.
    #[error(
        "{format} data, which this build does not read; build haptical with `--features \
         {feature}`, or save the log as CSV"
    )]
    NotBuiltIn {
        /// What the file is.
        format: &'static str,
        /// Name of the feature.
        feature: &'static str,
    },
    /// A binary file that does not hold together.
    #[error("the {format} data is damaged or cut off ({what}); copy or record the file again")]
    Damaged {
        /// What the file is.
        format: &'static str,
        /// What does not fit.
        what: String,
    },
    /// A binary file or a table in memory that is sound but no log.
    #[error("{what}; {advice}")]
    NotALog {
        /// What is wrong.
        what: String,
        /// What to do.
        advice: String,
    },
    /// The cells are not separated by commas.
    #[error(
        "the cells are separated by {saw}; a log is separated by commas, with a point as \
         decimal sign: export it again so"
    )]
    WrongSeparator {
        /// The separator that was seen, in words.
        saw: &'static str,
    },
    /// The first line with text is not a header, or there is none.
    #[error(fmt = text::no_header)]
    NoHeader {
        /// First cell found instead, empty if there is none.
        found: String,
    },
    /// Two columns have one name.
    #[error("column {first} has this name already; rename or delete one of the two")]
    DuplicateColumn {
        /// Number of the earlier column, counted from 1.
        first: usize,
    },
    /// A joint of the device has no column of readings.
    #[error(fmt = text::missing_column)]
    MissingColumn {
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
        /// Columns that are there.
        present: Vec<String>,
        /// Columns that are not.
        missing: Vec<String>,
    },
    /// There is a header and nothing below it.
    #[error("no rows below the header; record at least 2 rows")]
    NoRows,
    /// There are too few rows.
    #[error("only {rows} row; record at least 2 rows")]
    TooFewRows {
        /// Number of rows.
        rows: usize,
    },
    /// A row has more or fewer cells than the header.
    #[error("{got} cells where the header has {expected}; {advice}")]
    CellCount {
        /// Number of cells in the row.
        got: usize,
        /// Number of cells in the header.
        expected: usize,
        /// What it probably is and what to do.
        advice: &'static str,
    },
    /// A cell contains a line break, so a quotation mark was opened and not closed.
    #[error("a quotation mark opens here and is not closed on this line; close or delete it")]
    UnclosedQuote,
    /// Text where a number is needed.
    #[error(
        "expected a number, found `{found}`; correct it, or leave the cell empty where \
         there is no reading"
    )]
    NotANumber {
        /// The text, shortened.
        found: String,
    },
    /// A number with a comma as decimal sign.
    #[error(
        "expected a number, found `{found}`; the decimal sign must be a point: export the \
         log again so"
    )]
    DecimalComma {
        /// The text.
        found: String,
    },
    /// Not-a-number or infinity written in a cell.
    #[error("`{found}` is not a finite number; leave the cell empty where there is no reading")]
    NotFinite {
        /// The text.
        found: String,
    },
    /// A reading that no device has.
    #[error(
        "`{found}` is beyond what any device measures, {largest:e} in SI units; correct it, \
         or leave the cell empty where there is no reading"
    )]
    ReadingTooLarge {
        /// The text, shortened.
        found: String,
        /// Largest reading.
        largest: f64,
    },
    /// An empty cell in a column that each row needs.
    #[error("empty, but each row needs this reading; fill it in or delete the row")]
    MissingReading,
    /// Time stands still or runs backwards within a run.
    #[error(
        "time {time_s} s does not come after {previous_s} s of line {previous_line}; sort \
         the rows by time, delete repeated ones, or give each recording its own number in a column `run`"
    )]
    TimeOrder {
        /// Its time \[s\].
        time_s: f64,
        /// Line of the row before.
        previous_line: u64,
        /// Time of the row before \[s\].
        previous_s: f64,
    },
    /// A run's number is not an integer, or is empty.
    #[error("a run is numbered by an integer in each row, found `{found}`; write a whole number")]
    RunNotInteger {
        /// The text.
        found: String,
    },
    /// A run continues after another run has begun.
    #[error(
        "run {run} continues here, but it ended at line {previous_line}; put the rows of a \
         run next to each other or give them different numbers"
    )]
    RunNotContiguous {
        /// The run.
        run: i64,
        /// Last line of the run's earlier rows.
        previous_line: u64,
    },
    /// All four parts of an orientation are zero.
    #[error("the quaternion is zero; leave the four cells empty where there is no reading")]
    ZeroQuaternion,
    /// An orientation is no unit quaternion.
    #[error(
        "the quaternion has norm {norm}, which must be 1 within {allowed}; check the four \
         columns qw, qx, qy, qz and their number of digits"
    )]
    QuaternionNorm {
        /// Its norm.
        norm: f64,
        /// Allowed deviation of the norm from 1.
        allowed: f64,
    },
    /// A column of hands, and a device that has but one.
    #[error(
        "the column says which hand a row is about, and the device file has no [[hand]]; add one for each hand \
         to the device file, or delete the column"
    )]
    HandColumn,
    /// No column of hands, and a device that has several.
    #[error(
        "the device has the hands {}, and no column `hand` says which of them a row is about; add the column",
        near_miss::list(.hands)
    )]
    NoHandColumn {
        /// The device's hands.
        hands: Vec<String>,
    },
    /// A hand that the device does not have.
    #[error(
        "the device has no hand `{found}`; name {} in each row, or declare it with [[hand]] in the device file",
        near_miss::list(.hands)
    )]
    UnknownHand {
        /// The name.
        found: String,
        /// The device's hands.
        hands: Vec<String>,
    },
    /// A distance below zero.
    #[error(
        "distance {value_m} m is negative; the column holds the distance from the cable's \
         exit to the handle: add the distance at the encoder's zero, or correct its direction"
    )]
    NegativeDistance {
        /// The distance \[m\].
        value_m: f64,
    },
    /// Readings far outside the joint's limits that would fit as degrees.
    #[error(
        "looks like degrees: the readings go from {min} to {max}, the device's limits from \
         {lower_rad} to {upper_rad} rad; multiply the column by pi/180 ({}if it holds motor angles, \
         divide by the transmission ratio; if the joint does turn so far, widen its limits)",
        turns(*.within_a_turn)
    )]
    LooksLikeDegrees {
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
    /// Readings that are neither radians nor degrees of any joint like this.
    #[error(
        "looks like encoder counts: the readings are whole numbers from {min} to {max}, the device's limits from {lower_rad} to \
         {upper_rad} rad; give radians of the joint: counts times 2 pi over the counts of a turn, over the transmission ratio for \
         an encoder of the motor (if the joint does turn so far, widen its limits)"
    )]
    LooksLikeCounts {
        /// Smallest reading.
        min: f64,
        /// Largest reading.
        max: f64,
        /// Lower limit of the joint \[rad\].
        lower_rad: f64,
        /// Upper limit of the joint \[rad\].
        upper_rad: f64,
    },
    /// The shape describes no device.
    #[error("a log cannot be matched to a device without joints; correct the device file")]
    InvalidShape,
    /// A recording in memory that cannot be written as a log.
    #[error("the recording cannot be written: {what}")]
    InvalidRecording {
        /// What is wrong and what would be right.
        what: String,
    },
    /// The operating system would not let the file be written.
    #[error("cannot be written ({source}); check that the folder exists and has room")]
    Unwritable {
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
