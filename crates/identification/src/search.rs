//! The state of a search: where it is, whether that is a minimum, and whether a trial is better.

use haptical_linalg::{Matrix, Reduction, Solution};

use crate::problem::by_parameter;
use crate::triangle::Triangle;
use crate::{Convergence, Form, IdentificationError, Problem, Settings};

/// Promised fall, as a share of the cost, that the rounding of the cost can hide.
const UNSEEN_FALL: f64 = 1e-9;

/// Share of the parameters below which a step cannot be told from rounding in the residuals.
const UNSEEN_STEP: f64 = 1e-8;

/// A millimetre or a milliradian, so that parameters near zero can converge too.
const SMALLEST_SCALE: f64 = 1e-3;

/// A step after which a parameter has lost all but this share of its effect is refused: on such a
/// plateau no derivative leads back (NIST's BoxBOD, where a rate leaps to where all has decayed).
const COLLAPSE: f64 = 1e-6;

/// The linearised problem where the search is.
#[derive(Debug)]
enum Linear {
    /// Reduced by a pivoted QR of all rows.
    Reduced(Reduction),
    /// Handed over as a triangle, and room for that of a trial.
    Triangle(Box<[Triangle; 2]>),
}

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
    trial_residuals: Vec<f64>,
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
        let linear = if problem.form() == Form::Triangle {
            let room = || Triangle::new(rows, free.len());
            let mut triangles = Box::new([room(), room()]);
            triangles[0].evaluate(problem, start, free)?;
            if !triangles[0].is_finite() {
                // refuses, and says what is not finite
                reduce(
                    problem,
                    &triangles[0].jacobian,
                    &triangles[0].residuals,
                    free,
                )?;
            }
            residuals.copy_from_slice(&triangles[0].residuals);
            Linear::Triangle(triangles)
        } else {
            jacobian = Matrix::zeros(rows, free.len());
            problem.evaluate(start, &mut residuals, Some((free, &mut jacobian)))?;
            Linear::Reduced(reduce(problem, &jacobian, &residuals, free)?)
        };
        Ok(Self {
            problem,
            free,
            columns: (0..free.len()).collect(),
            settings,
            parameters: start.to_vec(),
            trial_residuals: vec![0.0; rows],
            cost: sum_of_squares(&residuals),
            residuals,
            jacobian,
            linear,
            evaluations: 1,
        })
    }

    /// Euclidean norms of the columns.
    pub(crate) fn column_norms(&self) -> &[f64] {
        match &self.linear {
            Linear::Reduced(reduction) => reduction.column_norms(),
            Linear::Triangle(triangles) => &triangles[0].norms,
        }
    }

    /// The undamped step of the linearised problem, which measures convergence for both methods.
    pub(crate) fn newton(&self) -> Result<Solution, IdentificationError> {
        let tolerance = self.settings.rank_tolerance;
        match &self.linear {
            Linear::Reduced(reduction) => Ok(reduction.solve(&self.columns, 0.0, tolerance)?),
            Linear::Triangle(triangles) => self.newton_of(&triangles[0]),
        }
    }

    fn newton_of(&self, triangle: &Triangle) -> Result<Solution, IdentificationError> {
        let tolerance = self.settings.rank_tolerance;
        match triangle.newton(tolerance) {
            Some(step) => Ok(step),
            None => Ok(triangle.reduction()?.solve(&self.columns, 0.0, tolerance)?),
        }
    }

    /// The step damped by `damping` times the weighted column norms.
    pub(crate) fn damped(
        &self,
        damping: f64,
        weights: &[f64],
    ) -> Result<Solution, IdentificationError> {
        let (columns, tolerance) = (&self.columns, self.settings.rank_tolerance);
        let fallback;
        let reduction = match &self.linear {
            Linear::Reduced(reduction) => reduction,
            Linear::Triangle(triangles) => {
                if let Some(step) = triangles[0].damped(damping, weights, tolerance) {
                    return Ok(step);
                }
                fallback = triangles[0].reduction()?;
                &fallback
            }
        };
        Ok(reduction.solve_weighted(columns, damping, weights, tolerance)?)
    }

    /// The linearised problem, reduced.
    pub(crate) fn into_parts(self) -> Result<(Vec<f64>, Vec<f64>, Reduction), IdentificationError> {
        let reduction = match self.linear {
            Linear::Reduced(reduction) => reduction,
            Linear::Triangle(triangles) => triangles[0].reduction()?,
        };
        Ok((self.parameters, self.residuals, reduction))
    }

    /// Whether the parameters are a minimum, judged by the undamped step.
    pub(crate) fn converged(&self, newton: &Solution) -> Option<Convergence> {
        // No residual is known better than the parameters' own rounding allows.
        let rounding = self.rounding();
        let reason = if self.cost <= rounding {
            Convergence::ExactFit
        } else if newton.explained_square <= self.settings.cost_tolerance * self.cost {
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
        if let Linear::Triangle(triangles) = &mut self.linear {
            let [_, after] = &mut **triangles;
            if after.evaluate(self.problem, &trial, self.free).is_err() || !after.is_finite() {
                return Ok(false);
            }
            return self.try_triangle(trial, newton);
        }
        let cost = match self
            .problem
            .evaluate(&trial, &mut self.trial_residuals, None)
        {
            Ok(()) => sum_of_squares(&self.trial_residuals),
            Err(_) => return Ok(false),
        };
        if !self.is_better(cost, newton) {
            return Ok(false);
        }
        // A place without derivatives is no place to go on from, as one without residuals is.
        let derivatives = Some((self.free, &mut self.jacobian));
        let evaluated = self
            .problem
            .evaluate(&trial, &mut self.trial_residuals, derivatives);
        if evaluated.is_err() {
            return Ok(false);
        }
        self.evaluations += 1;
        let reduced = reduce(
            self.problem,
            &self.jacobian,
            &self.trial_residuals,
            self.free,
        );
        let Ok(reduction) = reduced else {
            return Ok(false);
        };
        if has_vanished(reduction.column_norms(), self.column_norms()) {
            return Ok(false);
        }
        if cost >= self.cost {
            let after = reduction.solve(&self.columns, 0.0, self.settings.rank_tolerance)?;
            if after.explained_square > 0.5 * newton.explained_square {
                return Ok(false);
            }
        }
        std::mem::swap(&mut self.residuals, &mut self.trial_residuals);
        self.linear = Linear::Reduced(reduction);
        self.parameters = trial;
        self.cost = cost;
        Ok(true)
    }

    /// As [`Search::try_move`], the trial's triangle being there already.
    fn try_triangle(
        &mut self,
        trial: Vec<f64>,
        newton: &Solution,
    ) -> Result<bool, IdentificationError> {
        let Linear::Triangle(triangles) = &self.linear else {
            return Ok(false);
        };
        let [before, after] = &**triangles;
        let cost = sum_of_squares(&after.residuals);
        if !self.is_better(cost, newton) || has_vanished(&after.norms, &before.norms) {
            return Ok(false);
        }
        if cost >= self.cost {
            let after = self.newton_of(after)?;
            if after.explained_square > 0.5 * newton.explained_square {
                return Ok(false);
            }
        }
        if let Linear::Triangle(triangles) = &mut self.linear {
            triangles.swap(0, 1);
            self.residuals.copy_from_slice(&triangles[0].residuals);
        }
        self.parameters = trial;
        self.cost = cost;
        Ok(true)
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

pub(crate) fn sum_of_squares(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}
