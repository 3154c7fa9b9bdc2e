//! Reasons to refuse a plan.

use haptical_calibration::CalibrationError;
use haptical_identification::IdentificationError;
use haptical_model::ModelError;

/// Why there is no plan.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DesignError {
    /// A measurement that cannot be read.
    #[error("measurement `{item}`: {message}")]
    Measure {
        /// As it was given.
        item: String,
        /// What is wrong and what is allowed.
        message: String,
    },
    /// A setting outside its domain.
    #[error("{setting} is {value}: give {allowed}")]
    Setting {
        /// Name.
        setting: &'static str,
        /// Value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A joint without the limits that poses are drawn between.
    #[error(
        "joint {joint} has no finite limits: give lower_{unit} and upper_{unit} in its [[joint]]"
    )]
    NoLimits {
        /// Joint, from 1.
        joint: usize,
        /// `rad` or `m`.
        unit: &'static str,
    },
    /// Too few poses pass the limits.
    #[error(
        "only {found} of {wanted} candidate poses found in {drawn} draws, most of them refused by \
         {filter}: widen that limit or ask for fewer candidates"
    )]
    NoCandidates {
        /// Poses that passed.
        found: usize,
        /// Poses asked for.
        wanted: usize,
        /// Poses drawn.
        drawn: usize,
        /// What refused most.
        filter: &'static str,
    },
    /// A rig that identifies nothing.
    #[error("rig `{rig}` identifies no parameter of this device: {reason}")]
    NothingIdentifiable {
        /// The rig.
        rig: String,
        /// Why.
        reason: String,
    },
    /// Too few poses for the parameters.
    #[error(
        "{poses} poses with {readings} readings cannot fix {parameters} parameters: ask for at \
         least {advised} poses"
    )]
    TooFewPoses {
        /// Poses asked for.
        poses: usize,
        /// Readings that they give, those already there included.
        readings: usize,
        /// Parameters that the rig identifies.
        parameters: usize,
        /// How many to ask for.
        advised: usize,
    },
    /// More poses than candidates.
    #[error("{poses} poses are asked of {candidates} candidates: ask for more candidates")]
    TooFewCandidates {
        /// Poses asked for.
        poses: usize,
        /// Candidates.
        candidates: usize,
    },
    /// A task that this device does not have.
    #[error("{message}")]
    Task {
        /// What is missing and what to do.
        message: String,
    },
    /// The device has no value at a pose.
    #[error("candidate pose {pose}: {source}; narrow the joint limits")]
    Pose {
        /// Which, from 1.
        pose: usize,
        /// Why.
        source: ModelError,
    },
    /// The calibration refuses a candidate.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// The analysis refuses.
    #[error(transparent)]
    Identification(#[from] IdentificationError),
}

impl DesignError {
    /// The refusal of a pose by its index, from 0.
    pub(crate) fn of_pose(index: usize) -> impl Fn(ModelError) -> Self {
        move |source| Self::Pose {
            pose: index + 1,
            source,
        }
    }
}

impl From<haptical_linalg::LinalgError> for DesignError {
    fn from(error: haptical_linalg::LinalgError) -> Self {
        Self::Identification(error.into())
    }
}
