//! Errors of matrices and of questions about them.

/// Why a decomposition or a solution was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinalgError {
    /// A matrix without rows or without columns.
    #[error("the matrix is empty ({rows} rows, {columns} columns)")]
    Empty {
        /// Rows given.
        rows: usize,
        /// Columns given.
        columns: usize,
    },
    /// An entry is NaN or infinite.
    #[error("entry (row {row}, column {column}) is {value}, not a finite number")]
    NotFinite {
        /// Row, from 0.
        row: usize,
        /// Column, from 0; equal to the number of columns for the right-hand side.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// Shapes that do not fit each other.
    #[error("{what}: expected length {expected}, found {found}")]
    Shape {
        /// Which argument.
        what: &'static str,
        /// Length wanted.
        expected: usize,
        /// Length given.
        found: usize,
    },
    /// A column index out of range or given twice.
    #[error("column {column} is out of range or repeated (the matrix has {columns} columns)")]
    Column {
        /// Index given.
        column: usize,
        /// Columns of the matrix.
        columns: usize,
    },
    /// An argument outside its range.
    #[error("{what} is {value}, allowed: {allowed}")]
    OutOfRange {
        /// Which argument.
        what: &'static str,
        /// Value given.
        value: f64,
        /// Range.
        allowed: &'static str,
    },
    /// A result that no double-precision number can hold: change the units of the problem.
    #[error("{what} overflows: the largest number here is 1.8e308, choose other units")]
    Overflow {
        /// Which result.
        what: &'static str,
    },
    /// The columns are not independent, so the question has no answer.
    #[error("the {columns} chosen columns have rank {rank}: leave out dependent columns first")]
    RankDeficient {
        /// Rank found.
        rank: usize,
        /// Columns chosen.
        columns: usize,
    },
    /// The iteration inside a decomposition did not converge or ran out of memory.
    #[error("{what} failed on a {rows} x {columns} matrix")]
    Decomposition {
        /// Which decomposition.
        what: &'static str,
        /// Rows.
        rows: usize,
        /// Columns.
        columns: usize,
    },
}

/// Refuses an argument of another length.
pub(crate) fn check_length(
    what: &'static str,
    expected: usize,
    found: usize,
) -> Result<(), LinalgError> {
    if expected == found {
        return Ok(());
    }
    Err(LinalgError::Shape {
        what,
        expected,
        found,
    })
}

/// Refuses a right-hand side of another length than the matrix has rows, or with an entry that is not finite.
pub(crate) fn check_rhs(rhs: &[f64], rows: usize, columns: usize) -> Result<(), LinalgError> {
    check_length("right-hand side", rows, rhs.len())?;
    match rhs.iter().position(|entry| !entry.is_finite()) {
        None => Ok(()),
        Some(row) => Err(LinalgError::NotFinite {
            row,
            column: columns,
            value: rhs[row],
        }),
    }
}
