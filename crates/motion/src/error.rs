//! Why a log of a moving arm says nothing.

use haptical_model::ModelError;

/// Why the torques of a motion cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MotionError {
    /// The log has no column that is needed.
    #[error("{what} is missing: {why}")]
    Missing {
        /// Column or key.
        what: String,
        /// What it is wanted for.
        why: &'static str,
    },
    /// Samples are too far apart, or too few.
    #[error("{0}")]
    Sampling(String),
    /// Nothing moves.
    #[error("no joint moves: torques at rest say nothing of inertia and friction")]
    Standstill,
    /// A fit has no solution.
    #[error("the fit of the dynamics failed: {0}")]
    Fit(String),
    /// No torque changes.
    #[error("every torque column has one value throughout: nothing was measured there")]
    Constant,
    /// The torques are noise.
    #[error(
        "the torques are noise alone: none is larger than what its readings scatter by, and so is what the links ask for"
    )]
    Noise,
    /// The device cannot be evaluated.
    #[error(transparent)]
    Model(#[from] ModelError),
}

impl MotionError {
    /// Of a log whose pieces without a gap are too short.
    pub(crate) fn too_short() -> Self {
        Self::Sampling(
            "no piece of the log without a gap is long enough: record at least 4 s of motion, without lost rows".to_owned(),
        )
    }
}

impl From<haptical_linalg::LinalgError> for MotionError {
    fn from(error: haptical_linalg::LinalgError) -> Self {
        Self::Fit(error.to_string())
    }
}
