//! Recordings that a device cannot be calibrated from.

use haptical_identification::IdentificationError;
use haptical_model::{ModelError, Recording};

/// Why a calibration was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrationError {
    /// The recording has no column that a device can be calibrated with.
    #[error(
        "the recording has no measurement for this device: it needs external encoders (outN_rad), \
         or [[link]] rows in the device and a distance (cable_m), position, orientation, contact, plane or \
         fixture"
    )]
    NoChannel,
    /// No joint moves, so nothing can be distinguished.
    #[error(
        "no joint moves in the recording ({rows} rows at one pose): record at many different poses"
    )]
    NoMotion {
        /// Rows.
        rows: usize,
    },
    /// Fewer readings than parameters.
    #[error(
        "{what}: {rows} readings cannot fix {parameters} parameters: record at least {advised} at \
         different poses"
    )]
    TooFewRows {
        /// Which fit.
        what: String,
        /// Readings.
        rows: usize,
        /// Parameters.
        parameters: usize,
        /// How many to record.
        advised: usize,
    },
    /// Nothing at all is independent.
    #[error("{what}: no parameter can be identified: {reason}")]
    NothingIdentifiable {
        /// Which fit.
        what: String,
        /// Why.
        reason: String,
    },
    /// The search did not end at a minimum.
    #[error(
        "{what}: {reason}; the nominal device may be far from the real one, or wild readings bend least squares: a \
             robust loss holds them off"
    )]
    NotConverged {
        /// Which fit.
        what: String,
        /// What the search said.
        reason: String,
    },
    /// Touches alone were measured, and the fit that meets them best has no size.
    #[error(
        "the touches, which tell no length, draw the device to a point where all of them agree ({what}, {share:.1e} of \
         its size left); add a known distance between two sockets ([[contact_pair]]), a cable or a tracker's position"
    )]
    Collapsed {
        /// Which fit.
        what: String,
        /// Share of its size that the device kept.
        share: f64,
    },
    /// The model has no value at a row of the recording.
    #[error("line {line} of the log: {source}")]
    Row {
        /// Line of the log.
        line: u64,
        /// What the model said.
        source: ModelError,
    },
    /// A touch of a point or plane, or a row about a tool or a run, that the device does not have a place for.
    #[error(
        "line {line} of the log, {column}: the device has no place for `{id}` yet: prepare the device with \
         this recording first"
    )]
    UnknownTouch {
        /// Line of the log.
        line: u64,
        /// Column.
        column: String,
        /// Point, plane, tool or run.
        id: String,
    },
    /// Something of the rig that does not fit the recording.
    #[error("{what}: {message}")]
    Rig {
        /// Which section of the device file or column of the log.
        what: String,
        /// What is wrong, and what to do.
        message: String,
    },
    /// A reading that no device can give.
    #[error("line {line} of the log, {column}: {message}")]
    Reading {
        /// Line of the log.
        line: u64,
        /// Column.
        column: String,
        /// What is wrong.
        message: String,
    },
    /// A column in metres whose readings lie too far away for a device of this size.
    #[error("{}{what}; {next}", line.map_or(String::new(), |line| format!("line {line} of the log: ")))]
    LooksLikeMillimetres {
        /// Line of the first reading, where the recording has lines.
        line: Option<u64>,
        /// The column, its middle reading and the device's reach.
        what: String,
        /// What to do.
        next: &'static str,
    },
    /// Columns that have one value throughout, though the device moves what they are of.
    #[error(
        "{} one value throughout, though the joints move what {} of: nothing was measured there; leave {} out, or record again with a \
         sensor that answers",
        has(columns),
        is(columns),
        it(columns)
    )]
    Stuck {
        /// Names.
        columns: Vec<String>,
    },
    /// A log that fits the device far better if it was written otherwise.
    #[error(
        "the log fits the device better with {what}: its residual is {after:.3} times the stated noise then, and \
         {before:.3} times as logged{}; {mend}",
        if *after < 0.5 * before { "" } else { ", where it is that of a mirror image of the device" }
    )]
    MistakenColumns {
        /// Which change makes it fit.
        what: String,
        /// Residual as logged, in units of the stated noise.
        before: f64,
        /// Residual with the change.
        after: f64,
        /// What to do.
        mend: &'static str,
    },
    /// A log that the device misses by far as it is, and several times less if it was written otherwise.
    #[error(
        "the log fits the device file better with {what}: it misses by {after:.1e} of the spread of what was measured then (angles \
         in rad), and by {before:.3} as logged; {mend}"
    )]
    MistakenLog {
        /// Which change makes it fit.
        what: String,
        /// Error of the device file as logged, over the spread of what was measured.
        before: f64,
        /// The same with the change.
        after: f64,
        /// What to do.
        mend: &'static str,
    },
    /// A refusal of the least squares.
    #[error("{what}: {source}")]
    Identification {
        /// Which fit.
        what: String,
        /// What it said.
        source: IdentificationError,
    },
    /// An option outside its range.
    #[error("option {name} is {value}, allowed: {allowed}")]
    Option {
        /// Name.
        name: &'static str,
        /// Value.
        value: String,
        /// Range.
        allowed: &'static str,
    },
}

impl CalibrationError {
    /// Whether the numbers are sound but fix nothing (exit status 3), as against bad input (2).
    pub fn is_unidentifiable(&self) -> bool {
        match self {
            Self::NoMotion { .. }
            | Self::TooFewRows { .. }
            | Self::NothingIdentifiable { .. }
            | Self::NotConverged { .. }
            | Self::Collapsed { .. } => true,
            // A model without a value at some row is a reading that cannot be true.
            Self::Identification { source, .. } => !matches!(
                source,
                IdentificationError::Evaluation { .. }
                    | IdentificationError::NotFinite { .. }
                    | IdentificationError::Interrupted
            ),
            _ => false,
        }
    }
}

fn has(columns: &[String]) -> String {
    match columns {
        [one] => format!("{one} has"),
        more => format!("{} have", more.join(", ")),
    }
}

fn is(columns: &[String]) -> &'static str {
    match columns {
        [_] => "it is",
        _ => "they are",
    }
}

fn it(columns: &[String]) -> &'static str {
    match columns {
        [_] => "it",
        _ => "them",
    }
}

/// A refusal of the least squares, with the name of the fit.
pub(crate) fn wrap(what: &str, source: IdentificationError) -> CalibrationError {
    CalibrationError::Identification {
        what: what.to_owned(),
        source,
    }
}

/// A refusal of the model, with the line of a recording's row.
pub(crate) fn at_row(recording: &Recording, row: usize) -> impl Fn(ModelError) -> CalibrationError {
    let line = recording.line.get(row).copied().unwrap_or(0);
    move |source| CalibrationError::Row { line, source }
}
