//! Settings of a search, and the reasons why it stops.

use serde::{Deserialize, Serialize};

use crate::{IdentificationError, Interrupt};

/// The two methods that the paper names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Full steps of the linearised problem, halved where the cost would rise.
    GaussNewton,
    /// Damped steps (Levenberg 1944, Marquardt 1963) with Nielsen's update of the damping and Moré's
    /// scaling.
    LevenbergMarquardt,
}

/// Settings of a fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Settings {
    /// Search method.
    pub method: Method,
    /// Most accepted steps before giving up; a damped search then goes on once more from where it is, with a longer memory.
    pub max_iterations: usize,
    /// Stop when the fall of the cost that the undamped step promises is below this share of it: the
    /// square of Bates & Watts' (1981) relative offset, the cosine between residual and derivatives. The
    /// default 1e-20 leaves ten digits of the parameters where the data have them (docs/evidence/solver.md).
    pub cost_tolerance: f64,
    /// Stop when that promise is below this many squared residuals, whatever their sum; none where no fall is too small.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub least_promise: Option<f64>,
    /// Stop when each parameter's undamped step is below this share of its size (plus 1e-3 in its unit).
    pub step_tolerance: f64,
    /// Relative pivot below which a direction is left out of a step.
    pub rank_tolerance: f64,
    /// A minimum that others are only compared with needs few digits: stop where the undamped step is a tenth of a standard deviation
    /// (a fall of a hundredth of the residuals' mean square), and a slow search where a step lowers the cost by less than this share
    /// of it. None for a search whose numbers are kept.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub least_fall: Option<f64>,
    /// First damping of Levenberg-Marquardt, relative to unit-norm columns; less where the first undamped step promises less than a
    /// hundredth of the cost, as the search begins close to a minimum then.
    pub initial_damping: f64,
    /// Stops the search from another thread; no setting of its numbers.
    #[serde(skip)]
    pub interrupt: Interrupt,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            method: Method::LevenbergMarquardt,
            max_iterations: 1000,
            cost_tolerance: 1e-20,
            least_promise: None,
            step_tolerance: 1e-13,
            rank_tolerance: 1e-12,
            least_fall: None,
            initial_damping: 1e-6,
            interrupt: Interrupt::default(),
        }
    }
}

impl Settings {
    /// Share of the cost that a step of a slow search lowers it by at least, where the minimum is only compared.
    pub const COMPARED: f64 = 1e-4;

    /// The same for a minimum that others are only compared with.
    #[must_use]
    pub fn to_compare(&self) -> Self {
        Self {
            least_fall: Some(self.least_fall.unwrap_or(Self::COMPARED)),
            ..self.clone()
        }
    }

    /// Refuses settings outside their range.
    ///
    /// # Errors
    /// [`IdentificationError::Setting`].
    pub fn check(&self) -> Result<(), IdentificationError> {
        use IdentificationError as Refusal;
        Refusal::unless_share("cost_tolerance", self.cost_tolerance)?;
        Refusal::unless_share("step_tolerance", self.step_tolerance)?;
        Refusal::unless_share("rank_tolerance", self.rank_tolerance)?;
        Refusal::unless(self.max_iterations > 0, "max_iterations", 0.0, "at least 1")?;
        if let Some(least) = self.least_promise {
            let is_allowed = least.is_finite() && least >= 0.0;
            Refusal::unless(is_allowed, "least_promise", least, "at least 0")?;
        }
        if let Some(least_fall) = self.least_fall {
            Refusal::unless_share("least_fall", least_fall)?;
        }
        let damping = self.initial_damping;
        let is_allowed = damping.is_finite() && damping > 0.0;
        Refusal::unless(is_allowed, "initial_damping", damping, "above 0")
    }
}

/// Why the search stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Convergence {
    /// The linearised problem promises no further fall of the cost.
    SmallCostChange,
    /// The step is negligible against the parameters.
    SmallStep,
    /// The cost is zero to rounding.
    ExactFit,
    /// No shorter or more damped step lowers the cost, although the linear model promises it.
    NoFurtherDescent,
    /// The iteration limit was reached.
    IterationLimit,
    /// The free parameters are or became dependent: the cost may be least, the parameters are not fixed.
    RankLost,
}

impl Convergence {
    /// Whether the parameters are a stationary point: a minimum, unless the search began on a maximum.
    pub fn was_successful(self) -> bool {
        matches!(
            self,
            Self::SmallCostChange | Self::SmallStep | Self::ExactFit
        )
    }
}

impl std::fmt::Display for Convergence {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(match self {
            Self::SmallCostChange => "converged: the cost no longer falls",
            Self::SmallStep => "converged: the step is negligible",
            Self::ExactFit => "converged: the fit is exact",
            Self::NoFurtherDescent => "stopped: no step lowers the cost",
            Self::IterationLimit => "stopped at the iteration limit",
            Self::RankLost => "stopped: the free parameters became dependent",
        })
    }
}
