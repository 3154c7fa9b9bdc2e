//! Criteria of a selection of poses, on the covariance that it gives.

use nalgebra::DMatrix;

use crate::select::change::Change;
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
        self.of(state, state.log_det, state.trace, state.readings)
    }

    /// What a change of the score is small or large against: variances have units, logarithms have none.
    pub(crate) fn scale(&self, score: f64) -> f64 {
        match self {
            Self::LogDet | Self::PerReading => 1.0,
            Self::Trace(_) => score.abs(),
        }
    }

    /// The pose that is not chosen and has the best score in the place of one that is `gone`, or as one more, and that score: the first
    /// of equals, none that is not above `least`.
    pub(crate) fn best(
        &self,
        state: &mut State<'_>,
        gone: Option<&Change>,
        least: f64,
    ) -> Option<(usize, f64)> {
        state.catch_up();
        let state = &*state;
        let (readings, log_det, trace) = gone.map_or((0, 0.0, 0.0), |gone| {
            (gone.readings(), gone.log_det, gone.trace)
        });
        let (readings, log_det, trace) = (
            state.readings - readings,
            state.log_det + log_det,
            state.trace + trace,
        );
        let mut changed = state.candidates.changed(gone);
        let mut best = (None, least);
        // det(I + G) that the best score asks for, for some readings: logarithms are dearer than all the rest
        let mut asked = (f64::NAN, 0, 0.0);
        for pose in (0..state.chosen.len()).filter(|&pose| !state.chosen[pose]) {
            let readings = readings + state.rows.readings(pose);
            if asked.0 != best.1 || asked.1 != readings {
                asked = (
                    best.1,
                    readings,
                    (self.log_det(state, best.1, readings) - log_det).exp(),
                );
            }
            let (det, fall) = state.candidates.gains_at_most(&changed, pose);
            let is_hopeless = match self {
                Self::LogDet | Self::PerReading => det < (1.0 - ROUNDING) * asked.2,
                Self::Trace(_) => fall - trace < best.1 - ROUNDING * best.1.abs(),
            };
            if is_hopeless {
                continue;
            }
            let (det, fall) = state.candidates.gains(&mut changed, pose);
            let score = self.of(state, log_det + det.ln(), trace - fall, readings);
            if score > best.1 {
                best = (Some(pose), score);
            }
        }
        best.0.map(|pose| (pose, best.1))
    }

    /// ln det M of a score; nothing of a trace.
    fn log_det(&self, state: &State<'_>, score: f64, readings: usize) -> f64 {
        match self {
            Self::LogDet => score,
            Self::PerReading => {
                state.parameters().max(1) as f64 * (2.0 * score + (readings.max(1) as f64).ln())
            }
            Self::Trace(_) => f64::NEG_INFINITY,
        }
    }

    fn of(&self, state: &State<'_>, log_det: f64, trace: f64, readings: usize) -> f64 {
        match self {
            Self::LogDet => log_det,
            Self::PerReading => index(log_det, state.parameters(), readings),
            Self::Trace(_) => -trace,
        }
    }
}

/// Share by which rounding may have made a bound too small.
const ROUNDING: f64 = 1e-9;

/// ln O1.
fn index(log_det: f64, parameters: usize, readings: usize) -> f64 {
    0.5 * (log_det / parameters.max(1) as f64 - (readings.max(1) as f64).ln())
}
