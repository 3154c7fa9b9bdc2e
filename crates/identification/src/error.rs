//! Questions that have no answer. Numeric outcomes (rank, stopping reasons) are data, not errors.

use haptical_linalg::LinalgError;

/// Why a fit or an analysis was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IdentificationError {
    /// A vector whose length does not fit the problem.
    #[error("{what}: expected {expected} entries, found {found}")]
    Shape {
        /// Which argument.
        what: &'static str,
        /// Length wanted.
        expected: usize,
        /// Length given.
        found: usize,
    },
    /// Fewer measurements than free parameters.
    #[error("{rows} measurements cannot fix {parameters} parameters: record more, or free fewer")]
    TooFewRows {
        /// Measurements.
        rows: usize,
        /// Free parameters.
        parameters: usize,
    },
    /// Nothing to fit.
    #[error("no free parameter: nothing to identify")]
    NothingFree,
    /// The model could not be evaluated.
    #[error("the model cannot be evaluated: {reason}")]
    Evaluation {
        /// What the model said.
        reason: String,
    },
    /// The model gave a residual or derivative that is not finite.
    #[error(
        "the model gave {value} at row {row}, column {column} of the residuals and derivatives"
    )]
    NotFinite {
        /// Row, from 0.
        row: usize,
        /// Parameter, from 0; the number of parameters for the residual itself.
        column: usize,
        /// The value.
        value: f64,
    },
    /// A setting outside its range.
    #[error("setting {name} is {value}, allowed: {allowed}")]
    Setting {
        /// Field.
        name: &'static str,
        /// Value given.
        value: f64,
        /// Range.
        allowed: &'static str,
    },
    /// The covariance was asked for parameters that the data do not fix.
    #[error("the {parameters} parameters have rank {rank} at the solution: prune them first")]
    RankDeficient {
        /// Rank found.
        rank: usize,
        /// Parameters asked for.
        parameters: usize,
    },
    /// Stopped on request before the end.
    #[error("interrupted before the end")]
    Interrupted,
    /// A refusal of the linear algebra.
    #[error("linear algebra: {0}")]
    Linalg(LinalgError),
}

impl IdentificationError {
    /// Refuses a number outside its range.
    pub(crate) fn unless(
        is_allowed: bool,
        name: &'static str,
        value: f64,
        allowed: &'static str,
    ) -> Result<(), Self> {
        match is_allowed {
            true => Ok(()),
            false => Err(Self::Setting {
                name,
                value,
                allowed,
            }),
        }
    }

    /// Refuses a number that is no share: from 0 to below 1.
    pub(crate) fn unless_share(name: &'static str, value: f64) -> Result<(), Self> {
        Self::unless(
            (0.0..1.0).contains(&value),
            name,
            value,
            "from 0 to below 1",
        )
    }
}

impl From<LinalgError> for IdentificationError {
    fn from(error: LinalgError) -> Self {
        match error {
            LinalgError::NotFinite { row, column, value } => Self::NotFinite { row, column, value },
            LinalgError::RankDeficient { rank, columns } => Self::RankDeficient {
                rank,
                parameters: columns,
            },
            other => Self::Linalg(other),
        }
    }
}
