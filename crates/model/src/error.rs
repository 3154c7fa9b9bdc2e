//! Errors of device files and of evaluating a device.

use std::path::PathBuf;

use haptical_dynamics::DynamicsError;
use haptical_kinematics::KinematicsError;
use haptical_transmission::LawError;

use crate::rigid_bodies::Missing;

/// A device file that cannot be used; each says where, and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceFileError {
    /// The file cannot be opened.
    #[error("{}: cannot be read: {source}", path.display())]
    Unreadable {
        /// File.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is too large for a device file.
    #[error("{}: larger than {mebibytes} MiB, the most that is read", path.display())]
    TooLarge {
        /// File.
        path: PathBuf,
        /// Most that is read \[MiB\].
        mebibytes: u64,
    },
    /// The file is not text in UTF-8.
    #[error("{}: not a text in UTF-8; {advice}", path.display())]
    NotText {
        /// File.
        path: PathBuf,
        /// What it probably is and what to do.
        advice: &'static str,
    },
    /// Not TOML.
    #[error("{at}: {message}; {advice}")]
    Syntax {
        /// Where.
        at: Box<Position>,
        /// What the parser said.
        message: String,
        /// What to do.
        advice: String,
    },
    /// A key that must be there is not.
    #[error("{at}: {place} has no `{key}`: {advice}")]
    MissingKey {
        /// Where.
        at: Box<Position>,
        /// Table, in words.
        place: String,
        /// Key.
        key: String,
        /// Next step.
        advice: String,
    },
    /// A value of the wrong type or out of its range.
    #[error("{at}: {place}: `{key}` is {found}, but {allowed}")]
    Value {
        /// Where.
        at: Box<Position>,
        /// Table, in words.
        place: String,
        /// Key.
        key: String,
        /// What is there.
        found: String,
        /// What may be there.
        allowed: String,
    },
    /// Counts that do not fit each other.
    #[error("{file}: {message}")]
    Shape {
        /// File.
        file: String,
        /// What does not fit.
        message: String,
    },
}

/// A place in a device file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Position {
    /// File.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1.
    pub column: usize,
}

impl std::fmt::Display for Position {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{}:{}:{}", self.file, self.line, self.column)
    }
}

impl DeviceFileError {
    /// The place in the file, where there is one.
    pub fn position(&self) -> Option<&Position> {
        match self {
            Self::Syntax { at, .. } | Self::MissingKey { at, .. } | Self::Value { at, .. } => {
                Some(at)
            }
            Self::Unreadable { .. }
            | Self::TooLarge { .. }
            | Self::NotText { .. }
            | Self::Shape { .. } => None,
        }
    }
}

/// A device that cannot be evaluated at some reading.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The device has no links, so it has no handle position.
    #[error("the device `{device}` has no [[link]] rows: only its transmissions can be evaluated")]
    NoLinks {
        /// Device name.
        device: String,
    },
    /// A vector of joint readings of the wrong length.
    #[error("expected {expected} joint readings, found {found}")]
    JointCount {
        /// Joints of the device.
        expected: usize,
        /// Readings given.
        found: usize,
    },
    /// The transmission of a joint.
    #[error("joint {joint}: {source}")]
    Transmission {
        /// Joint, from 1.
        joint: usize,
        /// What is wrong.
        source: LawError,
    },
    /// The chain.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
    /// A device with rows that follow another row's joint, where only one row per joint is served.
    #[error(
        "the device `{device}` has rows that follow another row's joint (`driven_by`); here only \
         devices with one row per joint are served"
    )]
    FollowingRows {
        /// Device name.
        device: String,
    },
    /// A device with hands, of which none is chosen.
    #[error(
        "the device `{device}` has several hands, and nothing says which one is meant: a log has the column \
         `hand`; what has no hand is made for one chain"
    )]
    NoHand {
        /// Device name.
        device: String,
    },
    /// A joint that the device does not have.
    #[error("the device has {joints} joints, no joint {joint}")]
    NoJoint {
        /// Joint, from 1.
        joint: usize,
        /// Joints of the device.
        joints: usize,
    },
    /// A posture in which the free joints cannot hold any wrench.
    #[error(
        "the free joints are singular here (condition number {condition:.1e}): move away from this posture"
    )]
    Posture {
        /// Condition number of the Jacobian.
        condition: f64,
    },
    /// A row behind row 0 that no joint drives.
    #[error("the device `{device}` has rows that no joint drives, the first of them row {row}")]
    NoDrive {
        /// Device name.
        device: String,
        /// Row, row 0 leading to the base.
        row: usize,
    },
    /// A joint that moves no row, so that nothing is known of what it carries.
    #[error(
        "joint {joint} of the device `{device}` moves no row, so it carries nothing: give a row `driven_by = {joint}`"
    )]
    NoRow {
        /// Device name.
        device: String,
        /// Joint, from 1.
        joint: usize,
    },
    /// Numbers that a motion depends on and that the device file does not give.
    #[error(
        "the device `{device}` says too little for its motion: {}",
        listed(missing)
    )]
    Unweighed {
        /// Device name.
        device: String,
        /// What is missing, row by row.
        missing: Vec<Missing>,
    },
    /// The equations of motion have no value.
    #[error(transparent)]
    Dynamics(#[from] DynamicsError),
    /// A parameter that the device does not have.
    #[error("the device has no parameter `{name}`")]
    NoParameter {
        /// Name.
        name: String,
    },
}

fn listed(missing: &[Missing]) -> String {
    let words: Vec<String> = missing.iter().map(Missing::to_string).collect();
    words.join(", ")
}
