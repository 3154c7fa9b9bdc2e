//! The state of a search: where it is, whether that is a minimum, and whether a trial is better.

use haptical_linalg::{Matrix, Reduction, Solution};

use crate::problem::{by_parameter, evaluate_jacobian, sum_of_squares};
use crate::search::curvature::Normal;
use crate::search::linear::Linear;
use crate::search::triangle::UnitTriangle;
use crate::{Convergence, IdentificationError, Problem, Settings, TriangleProblem};

/// Promised fall, as a share of the cost, that the rounding of the cost can hide.
const UNSEEN_FALL: f64 = 1e-9;

/// Promised fall, in mean squares of the residuals, at which a minimum is near enough to be compared with others.
const NEAR: f64 = 0.01;

/// Share of the parameters below which a step cannot be distinguished from rounding in the residuals.
pub(crate) const UNSEEN_STEP: f64 = 1e-8;

/// A millimetre or a milliradian, so that parameters near zero can converge too.
pub(crate) const SMALLEST_SCALE: f64 = 1e-3;

/// A step after which a parameter has lost all but this share of its effect is refused: on such a
/// plateau no derivative leads back (NIST's BoxBOD, where a rate leaps to where all has decayed).
const COLLAPSE: f64 = 1e-6;

pub(crate) struct Search<'a, P: ?Sized> {
    pub(crate) problem: &'a P,
    pub(crate) free: &'a [usize],
    pub(crate) columns: Vec<usize>,
    pub(crate) settings: &'a Settings,
    pub(crate) parameters: Vec<f64>,
    pub(crate) residuals: Vec<f64>,
    /// Room for the derivatives; their reduction is what is kept.
    jacobian: Matrix,
    linear: Linear,
    pub(crate) cost: f64,
    pub(crate) evaluations: usize,
}

impl<'a, P: Problem + ?Sized> Search<'a, P> {
    pub(crate) fn new(
        problem: &'a P,
        start: &[f64],
        free: &'a [usize],
        settings: &'a Settings,
    ) -> Result<Self, IdentificationError> {
        let rows = problem.residual_count();
        let mut residuals = vec![0.0; rows];
        let mut jacobian = Matrix::zeros(0, 0);
        let linear = if let Some(triangle) = problem.as_triangle() {
            let linear = UnitTriangle::new(triangle, start, free)?;
            if !linear.is_finite() {
                // refuses, and names what is not finite
                let (jacobian, residuals) = evaluate_jacobian(problem, start, free)?;
                reduce(problem, &jacobian, &residuals, free)?;
            }
            residuals = linear.residuals();
            Linear::Triangle(Box::new(linear))
        } else {
            jacobian = Matrix::zeros(rows, free.len());
            problem.evaluate(start, &mut residuals, Some((free, &mut jacobian)))?;
            Linear::Rows(reduce(problem, &jacobian, &residuals, free)?)
        };
        Ok(Self {
            problem,
            free,
            columns: (0..free.len()).collect(),
            settings,
            parameters: start.to_vec(),
            cost: sum_of_squares(&residuals),
            residuals,
            jacobian,
            linear,
            evaluations: 1,
        })
    }

    /// Euclidean norms of the columns.
    pub(crate) fn column_norms(&self) -> &[f64] {
        self.linear.column_norms()
    }

    /// The undamped step of the linearised problem, which measures convergence for both methods.
    pub(crate) fn newton(&self) -> Result<Solution, IdentificationError> {
        self.linear
            .newton(&self.columns, self.settings.rank_tolerance)
    }

    /// The step damped by `damping` times the weighted column norms.
    pub(crate) fn damped(
        &self,
        damping: f64,
        weights: &[f64],
    ) -> Result<Solution, IdentificationError> {
        let tolerance = self.settings.rank_tolerance;
        self.linear
            .damped(&self.columns, (damping, weights), tolerance)
    }

    /// Normal matrix and gradient here.
    pub(crate) fn normal(&self) -> Result<Normal, IdentificationError> {
        self.linear.normal(&self.columns)
    }

    /// Parameters, residuals, and the linearised problem, reduced.
    pub(crate) fn into_parts(self) -> Result<(Vec<f64>, Vec<f64>, Reduction), IdentificationError> {
        let reduction = self.linear.into_reduction()?;
        Ok((self.parameters, self.residuals, reduction))
    }

    /// Whether the parameters are a minimum, judged by the undamped step.
    pub(crate) fn converged(&self, newton: &Solution) -> Option<Convergence> {
        // No residual is known better than the parameters' own rounding allows.
        let rounding = self.rounding();
        let reason = if self.cost <= rounding {
            Convergence::ExactFit
        } else if newton.explained_square <= self.least_promise() {
            Convergence::SmallCostChange
        } else if newton.explained_square <= rounding
            || self.is_small(newton, self.settings.step_tolerance)
        {
            Convergence::SmallStep
        } else {
            return None;
        };
        Some(self.unless_rank_lost(newton, reason))
    }

    /// Whether the undamped step moves the parameters by less than a tenth of a standard deviation in all.
    pub(crate) fn is_near(&self, newton: &Solution) -> bool {
        let rows = self.problem.as_triangle();
        let rows = rows.map_or(self.residuals.len(), TriangleProblem::rows);
        newton.explained_square * rows as f64 <= NEAR * self.cost
    }

    /// Promised fall that is none.
    fn least_promise(&self) -> f64 {
        let share = self.settings.cost_tolerance * self.cost;
        self.settings
            .least_promise
            .map_or(share, |least| share.max(least))
    }

    /// No trial lowered the cost: at a minimum the promise itself is only rounding.
    pub(crate) fn stuck(&self, newton: &Solution) -> Convergence {
        let reason = if newton.explained_square <= UNSEEN_FALL * self.cost {
            Convergence::SmallCostChange
        } else if self.is_small(newton, UNSEEN_STEP) {
            Convergence::SmallStep
        } else {
            Convergence::NoFurtherDescent
        };
        self.unless_rank_lost(newton, reason)
    }

    /// A minimum along a valley of dependent parameters is no estimate of them.
    pub(crate) fn unless_rank_lost(&self, newton: &Solution, reason: Convergence) -> Convergence {
        if newton.rank < self.free.len() && reason.was_successful() {
            Convergence::RankLost
        } else {
            reason
        }
    }

    /// Square of what rounding the parameters alone does to the residuals.
    pub(crate) fn rounding(&self) -> f64 {
        let effects = self.free.iter().zip(self.column_norms());
        effects
            .map(|(&index, norm)| (2.0 * f64::EPSILON * norm * self.parameters[index]).powi(2))
            .sum()
    }

    /// Residuals are model minus measurement, so the step is subtracted.
    pub(crate) fn trial(&self, step: &[f64], factor: f64) -> Vec<f64> {
        let mut trial = self.parameters.clone();
        for (&index, change) in self.free.iter().zip(step) {
            trial[index] -= factor * change;
        }
        trial
    }

    /// Goes to the trial point if that is an improvement.
    ///
    /// Near the minimum the fall of the cost drowns in rounding; there a step counts that leaves the
    /// cost as it is and halves the promise of the linearised problem.
    pub(crate) fn try_move(
        &mut self,
        trial: Vec<f64>,
        newton: &Solution,
    ) -> Result<bool, IdentificationError> {
        self.evaluations += 1;
        let Some((residuals, linear)) = self.linearised(&trial, newton) else {
            return Ok(false);
        };
        let cost = sum_of_squares(&residuals);
        if !self.is_better(cost, newton) || has_vanished(linear.column_norms(), self.column_norms())
        {
            return Ok(false);
        }
        if cost >= self.cost {
            let after = linear.newton(&self.columns, self.settings.rank_tolerance)?;
            if after.explained_square > 0.5 * newton.explained_square {
                return Ok(false);
            }
        }
        self.residuals = residuals;
        self.linear = linear;
        self.parameters = trial;
        self.cost = cost;
        Ok(true)
    }

    /// Residuals and the linearised problem at a trial point; none where it has no value or is no improvement.
    fn linearised(&mut self, trial: &[f64], newton: &Solution) -> Option<(Vec<f64>, Linear)> {
        if let Some(triangle) = self.problem.as_triangle() {
            let linear = UnitTriangle::new(triangle, trial, self.free).ok()?;
            let is_sound = linear.is_finite();
            return is_sound.then(|| (linear.residuals(), Linear::Triangle(Box::new(linear))));
        }
        let mut residuals = vec![0.0; self.residuals.len()];
        self.problem.evaluate(trial, &mut residuals, None).ok()?;
        let cost = sum_of_squares(&residuals);
        if !self.is_better(cost, newton) {
            return None;
        }
        // A place without derivatives is no place to go on from, as one without residuals is.
        let derivatives = Some((self.free, &mut self.jacobian));
        let evaluated = self.problem.evaluate(trial, &mut residuals, derivatives);
        evaluated.ok()?;
        self.evaluations += 1;
        let reduction = reduce(self.problem, &self.jacobian, &residuals, self.free);
        Some((residuals, Linear::Rows(reduction.ok()?)))
    }

    /// Whether a cost is lower, or as low where the fall cannot be seen.
    fn is_better(&self, cost: f64, newton: &Solution) -> bool {
        let unseen = newton.explained_square <= UNSEEN_FALL * self.cost
            && cost <= (1.0 + UNSEEN_FALL) * self.cost;
        // Written so that a NaN is refused.
        cost < self.cost || unseen
    }

    pub(crate) fn is_small(&self, step: &Solution, tolerance: f64) -> bool {
        self.free.iter().zip(&step.values).all(|(&index, change)| {
            change.abs() <= tolerance * (self.parameters[index].abs() + SMALLEST_SCALE)
        })
    }
}

/// Reduces the linearised problem; an entry that is not finite is named by parameter, not by column.
fn reduce<P: Problem + ?Sized>(
    problem: &P,
    jacobian: &Matrix,
    residuals: &[f64],
    free: &[usize],
) -> Result<Reduction, IdentificationError> {
    Reduction::new(jacobian, residuals).map_err(|error| by_parameter(error.into(), problem, free))
}

/// Whether a column has lost nearly all of its effect.
fn has_vanished(after: &[f64], before: &[f64]) -> bool {
    let mut norms = after.iter().zip(before);
    norms.any(|(after, before)| *after < COLLAPSE * before)
}
