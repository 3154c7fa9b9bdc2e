//! Criteria of a selection of poses, on the covariance that it gives.

use nalgebra::DMatrix;

use crate::select::state::State;
use crate::select::whitened::Whitened;

/// What is made best.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Criterion {
    /// Largest determinant of the information matrix: smallest volume of the confidence ellipsoid.
    D,
    /// Smallest mean variance of the device's parameters, each over its plausible size.
    A,
    /// Largest observability index O1 = (s_1 ... s_L)^(1/L) / sqrt(m) (Borm & Menq 1991). As the product of the
    /// singular values is the root of the determinant, it is D where every pose gives as many readings
    /// (Sun & Hollerbach 2008), and needs no singular value.
    O1,
    /// Smallest variance of the handle's position in a region.
    TaskPosition,
    /// Smallest variance of the direction of the force that the handle exerts in a region.
    TaskForce,
}

/// A criterion made ready for one design; larger scores are better.
#[derive(Debug)]
pub(crate) enum Score {
    LogDet,
    /// ln O1, up to a constant: L is the number of parameters.
    PerReading,
    Trace(DMatrix<f64>),
}

impl Score {
    pub(crate) fn new(criterion: Criterion, rows: &Whitened, task: &[Vec<f64>]) -> Self {
        match criterion {
            Criterion::D => Self::LogDet,
            Criterion::O1 => Self::PerReading,
            Criterion::A | Criterion::TaskPosition | Criterion::TaskForce => {
                Self::Trace(rows.task(task))
            }
        }
    }

    pub(crate) fn weight(&self) -> Option<&DMatrix<f64>> {
        match self {
            Self::Trace(weight) => Some(weight),
            Self::LogDet | Self::PerReading => None,
        }
    }

    /// The score of the present state.
    pub(crate) fn now(&self, state: &State<'_>) -> f64 {
        match self {
            Self::LogDet => state.log_det,
            Self::PerReading => index(state.log_det, state.parameters(), state.readings),
            Self::Trace(_) => -state.trace,
        }
    }

    /// What a change of the score is small or large against: variances have units, logarithms have none.
    pub(crate) fn scale(&self, score: f64) -> f64 {
        match self {
            Self::LogDet | Self::PerReading => 1.0,
            Self::Trace(_) => score.abs(),
        }
    }

    /// The score with one more pose.
    pub(crate) fn with(&self, state: &State<'_>, pose: usize) -> f64 {
        match self {
            Self::LogDet => state.log_det + state.log_det_gain(pose),
            Self::PerReading => {
                let readings = state.readings + state.rows.readings(pose);
                let log_det = state.log_det + state.log_det_gain(pose);
                index(log_det, state.parameters(), readings)
            }
            Self::Trace(_) => -(state.trace - state.trace_gain(pose)),
        }
    }
}

/// ln O1.
fn index(log_det: f64, parameters: usize, readings: usize) -> f64 {
    0.5 * (log_det / parameters.max(1) as f64 - (readings.max(1) as f64).ln())
}
