//! The problem whose noise is looked at, and what it may show.

use haptical_linalg::Matrix;

use crate::NoiseScale;

/// Residuals of one sensor axis in the order of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// Signals of one group are axes of one sensor: their noise is larger at the same places.
    pub group: usize,
    /// Rows of the derivative matrix, first to last.
    pub rows: Vec<usize>,
    /// Row of each of them in the covariates; the same for all signals of a group.
    pub at: Vec<usize>,
    /// Whether a parameter is the drift of this signal: then it has no line in time besides.
    pub has_drift: bool,
}

/// A linearised least-squares problem at its minimum, with the order of its rows.
#[derive(Debug, Clone, Copy)]
pub struct OrderedProblem<'a> {
    /// Derivatives of the weighted residuals, rows x parameters: those of the fit, then others that it held although they are
    /// uncertain.
    pub derivatives: &'a Matrix,
    /// Number of parameters of the fit.
    pub fitted: usize,
    /// Weighted residuals, model minus measurement over the stated standard deviation.
    pub residuals: &'a [f64],
    /// Which rows follow each other in time.
    pub signals: &'a [Signal],
    /// Numbers that the size of the noise may depend on, such as joint angles: a column each.
    pub covariates: &'a [Vec<f64>],
    /// Where the size of even noise without memory comes from.
    pub noise: NoiseScale,
    /// Covariance of those held parameters that an earlier step fitted, zero for the others: what their errors are expected to add to
    /// the residuals is no noise. None where nothing is known of any.
    pub known: Option<&'a Matrix>,
}

/// Noise that is larger in a part of the range of a covariate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uneven {
    /// Group of signals.
    pub group: usize,
    /// Covariate.
    pub covariate: usize,
    /// Largest standard deviation over the smallest.
    pub ratio: f64,
}
