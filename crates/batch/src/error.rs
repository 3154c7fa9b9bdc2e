//! Refusals of a batch or of a pass over it.

use haptical_kinematics::{KinematicsError, Parameter};

/// What was wrong, where, and what is needed instead.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BatchError {
    /// The chain itself is refused.
    #[error("the chain: {0}")]
    Chain(#[from] KinematicsError),
    /// A batch without poses.
    #[error("there is no pose; at least one is needed")]
    NoPose,
    /// A slice whose length does not fit.
    #[error("{what}: {found} entries; {expected} are needed")]
    Length {
        /// Which slice.
        what: &'static str,
        /// Entries needed.
        expected: usize,
        /// Entries given.
        found: usize,
    },
    /// A number of a pose that cannot be used.
    #[error("{what} of pose {pose} is {value}; {allowed} is needed")]
    Pose {
        /// Which number.
        what: &'static str,
        /// Pose, from 0.
        pose: usize,
        /// What it was.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A coordinate of the anchor that is not finite.
    #[error("the anchor is {anchor_m:?} m; finite coordinates are needed")]
    Anchor {
        /// The anchor.
        anchor_m: [f64; 3],
    },
    /// A parameter that the chain has not, or that is listed twice.
    #[error(
        "{parameter} of row {row} is listed twice or is of a row that the chain of {rows} rows has not"
    )]
    Parameter {
        /// Row, from 0.
        row: usize,
        /// Which of its parameters.
        parameter: Parameter,
        /// Rows of the chain.
        rows: usize,
    },
    /// The handle coincides with the anchor, where the distance has no derivative.
    #[error("pose {pose}: the handle coincides with the anchor; the distance has no derivative")]
    ZeroDistance {
        /// Pose, from 0.
        pose: usize,
    },
    /// The distance of a pose is too large to be squared.
    #[error("pose {pose}: the distance is too large to be squared; check the lengths' units")]
    OutOfRange {
        /// Pose, from 0.
        pose: usize,
    },
}

/// Refuses a slice of another length.
pub(crate) fn check_length(
    what: &'static str,
    expected: usize,
    found: usize,
) -> Result<(), BatchError> {
    if expected == found {
        return Ok(());
    }
    Err(BatchError::Length {
        what,
        expected,
        found,
    })
}
