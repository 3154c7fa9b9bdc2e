//! Says what was wrong with an input, where, and what was expected.

use crate::Parameter;

/// Every reason for which a function of this crate refuses to answer.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KinematicsError {
    /// A chain without rows has no end.
    #[error("the chain has no row; at least one is needed")]
    EmptyChain,
    /// The table and the list of motions describe chains of different lengths.
    #[error("{links} rows of parameters, but {motions} motions; one motion per row is needed")]
    RowCount {
        /// Rows of the parameter table.
        links: usize,
        /// Entries in the list of motions.
        motions: usize,
    },
    /// More constant transforms than there are places for them.
    #[error(
        "{origins} origins for {rows} rows; one before each row and one behind the last are the most"
    )]
    OriginCount {
        /// Rows of the parameter table.
        rows: usize,
        /// Origins given.
        origins: usize,
    },
    /// A constant transform that is not finite, or whose matrix is not a rotation.
    #[error(
        "the constant transform before row {row} is not a finite position with a rotation matrix"
    )]
    Origin {
        /// Row before which it is, counted from 0; the number of rows for that before the end.
        row: usize,
    },
    /// A parameter is infinite or not a number.
    #[error("row {row}: {parameter} is {value}; a finite number of {} is needed", parameter.unit())]
    NonFiniteParameter {
        /// Row of the table, counted from 0.
        row: usize,
        /// Which of its parameters.
        parameter: Parameter,
        /// What it was.
        value: f64,
    },
    /// The number of joint values is not the number of moving rows.
    #[error("{got} joint values; the chain has {expected} moving rows")]
    JointCount {
        /// Moving rows of the chain.
        expected: usize,
        /// Values given.
        got: usize,
    },
    /// A joint value is infinite or not a number.
    #[error("joint {joint} (row {row}) is {value}; a finite number is needed")]
    NonFiniteJoint {
        /// Joint, counted from 0 over the moving rows.
        joint: usize,
        /// Row of the table to which the joint belongs, counted from 0.
        row: usize,
        /// What it was.
        value: f64,
    },
    /// A joint value and the parameter to which it is added are finite, their sum is not.
    #[error("joint {joint} (row {row}): {value} added to the row's {parameter} overflows")]
    JointOverflow {
        /// Joint, counted from 0 over the moving rows.
        joint: usize,
        /// Row of the table to which the joint belongs, counted from 0.
        row: usize,
        /// Parameter to which the joint value is added.
        parameter: Parameter,
        /// The joint value.
        value: f64,
    },
    /// The chain leaves the range in which positions and their squares can be represented.
    #[error("row {row} ends more than {limit_m:e} m from frame (-1)")]
    PositionOutOfRange {
        /// First row beyond the limit, counted from 0.
        row: usize,
        /// Largest coordinate allowed, in m.
        limit_m: f64,
    },
    /// An output slice has the wrong length.
    #[error("{buffer} has room for {got} entries; {expected} are needed")]
    BufferLength {
        /// Which output.
        buffer: &'static str,
        /// Entries needed.
        expected: usize,
        /// Length of the slice.
        got: usize,
    },
    /// A vector has a component that is infinite or not a number.
    #[error("{vector} is {value:?}; finite components are needed")]
    NonFiniteVector {
        /// Which vector.
        vector: &'static str,
        /// Its components.
        value: [f64; 3],
    },
    /// The position coincides with the anchor, where the distance has no derivative.
    #[error(
        "the position {position_m:?} m coincides with the anchor; the distance has no derivative"
    )]
    ZeroDistance {
        /// The common position, in m.
        position_m: [f64; 3],
    },
    /// The inputs are finite, the result is too large to be represented.
    #[error("{quantity} is too large to be represented")]
    Overflow {
        /// Which result.
        quantity: &'static str,
    },
}
