//! Gauss-Newton and Levenberg-Marquardt on one QR reduction per iterate.

use haptical_linalg::{Matrix, Reduction};

use crate::problem::check_free;
use crate::{Convergence, IdentificationError, Method, Problem, Settings};

/// The outcome of a fit.
#[derive(Debug, Clone)]
pub struct Fit {
    /// All parameters; those that were not free keep their start.
    pub parameters: Vec<f64>,
    /// Sum of squared (weighted) residuals.
    pub cost: f64,
    /// Residuals at the solution.
    pub residuals: Vec<f64>,
    /// Accepted steps.
    pub iterations: usize,
    /// Evaluations of the model, with or without derivatives.
    pub evaluations: usize,
    /// Why the search stopped.
    pub convergence: Convergence,
    /// The linearised problem at the solution, over the free parameters in their order.
    pub reduction: Reduction,
}

/// Shortest Gauss-Newton step, and strongest damping steps, that are tried before giving up.
const MAX_HALVINGS: usize = 30;

/// Minimises the problem over the parameters `free`, from `start`.
///
/// Steps come from a pivoted QR of the scaled derivative matrix, never from normal equations.
/// Gauss-Newton halves a step that raises the cost; Levenberg-Marquardt adapts its damping by
/// Nielsen's rule (Madsen, Nielsen & Tingleff 2004, section 3.2).
///
/// # Errors
/// [`IdentificationError`] for shapes, settings, fewer residuals than free parameters or a model
/// that cannot be evaluated at the start. A search that stops early is not an error:
/// see [`Fit::convergence`].
pub fn solve<P: Problem + ?Sized>(
    problem: &P,
    start: &[f64],
    free: &[usize],
    settings: &Settings,
) -> Result<Fit, IdentificationError> {
    settings.check()?;
    check_free(problem, start, free)?;
    if problem.residual_count() < free.len() {
        return Err(IdentificationError::TooFewRows {
            rows: problem.residual_count(),
            parameters: free.len(),
        });
    }
    let mut search = Search::new(problem, start, free, settings)?;
    let mut damping = Damping {
        value: settings.initial_damping,
        growth: 2.0,
    };
    let mut iterations = 0;
    let convergence = loop {
        if search.cost <= search.exact_cost {
            break Convergence::ExactFit;
        }
        if iterations == settings.max_iterations {
            break Convergence::IterationLimit;
        }
        let outcome = match settings.method {
            Method::GaussNewton => search.gauss_newton()?,
            Method::LevenbergMarquardt => search.levenberg_marquardt(&mut damping)?,
        };
        match outcome {
            Outcome::Moved => iterations += 1,
            Outcome::Stop(reason) => break reason,
        }
    };
    Ok(Fit {
        parameters: search.parameters,
        cost: search.cost,
        residuals: search.residuals,
        iterations,
        evaluations: search.evaluations,
        convergence,
        reduction: search.reduction,
    })
}

enum Outcome {
    Moved,
    Stop(Convergence),
}

struct Damping {
    value: f64,
    growth: f64,
}

struct Search<'a, P: ?Sized> {
    problem: &'a P,
    free: &'a [usize],
    columns: Vec<usize>,
    settings: &'a Settings,
    parameters: Vec<f64>,
    residuals: Vec<f64>,
    jacobian: Matrix,
    reduction: Reduction,
    cost: f64,
    exact_cost: f64,
    evaluations: usize,
    trial_residuals: Vec<f64>,
}

impl<'a, P: Problem + ?Sized> Search<'a, P> {
    fn new(
        problem: &'a P,
        start: &[f64],
        free: &'a [usize],
        settings: &'a Settings,
    ) -> Result<Self, IdentificationError> {
        let rows = problem.residual_count();
        let mut residuals = vec![0.0; rows];
        let mut jacobian = Matrix::zeros(rows, free.len());
        problem.evaluate(start, &mut residuals, Some((free, &mut jacobian)))?;
        let reduction = Reduction::new(&jacobian, &residuals)?;
        let cost = sum_of_squares(&residuals);
        Ok(Self {
            problem,
            free,
            columns: (0..free.len()).collect(),
            settings,
            parameters: start.to_vec(),
            trial_residuals: vec![0.0; rows],
            residuals,
            jacobian,
            reduction,
            cost,
            // Below this the residuals are rounding of the first ones.
            exact_cost: cost * 1e-28,
            evaluations: 1,
        })
    }

    fn gauss_newton(&mut self) -> Result<Outcome, IdentificationError> {
        let step = self
            .reduction
            .solve(&self.columns, 0.0, self.settings.rank_tolerance)?;
        if step.rank < self.free.len() {
            return Ok(Outcome::Stop(Convergence::RankLost));
        }
        let promised = self.cost - step.residual_square;
        let last = promised <= self.settings.cost_tolerance * self.cost;
        let mut factor = 1.0;
        for _ in 0..MAX_HALVINGS {
            let trial = self.trial(&step.values, factor);
            if let Some(cost) = self.trial_cost(&trial)
                && cost < self.cost
            {
                let small = self.is_small(&step.values, factor);
                self.accept(trial, cost)?;
                return Ok(match (last, small) {
                    (true, _) => Outcome::Stop(Convergence::SmallCostChange),
                    (_, true) => Outcome::Stop(Convergence::SmallStep),
                    _ => Outcome::Moved,
                });
            }
            if last {
                return Ok(Outcome::Stop(Convergence::SmallCostChange));
            }
            factor *= 0.5;
        }
        Ok(Outcome::Stop(self.stuck(promised)))
    }

    fn levenberg_marquardt(
        &mut self,
        damping: &mut Damping,
    ) -> Result<Outcome, IdentificationError> {
        for _ in 0..MAX_HALVINGS {
            let step =
                self.reduction
                    .solve(&self.columns, damping.value, self.settings.rank_tolerance)?;
            let promised = self.cost - step.residual_square;
            let last = promised <= self.settings.cost_tolerance * self.cost;
            let trial = self.trial(&step.values, 1.0);
            if let Some(cost) = self.trial_cost(&trial)
                && cost < self.cost
            {
                let gain = (self.cost - cost) / promised;
                damping.value *= (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0);
                damping.value = damping.value.max(1e-15);
                damping.growth = 2.0;
                let small = self.is_small(&step.values, 1.0);
                self.accept(trial, cost)?;
                return Ok(match (last, small) {
                    (true, _) => Outcome::Stop(Convergence::SmallCostChange),
                    (_, true) => Outcome::Stop(Convergence::SmallStep),
                    _ => Outcome::Moved,
                });
            }
            // A heavily damped step promises little in any case: only an undamped promise counts.
            let undamped =
                self.reduction
                    .solve(&self.columns, 0.0, self.settings.rank_tolerance)?;
            if self.cost - undamped.residual_square <= self.settings.cost_tolerance * self.cost {
                return Ok(Outcome::Stop(Convergence::SmallCostChange));
            }
            damping.value *= damping.growth;
            damping.growth *= 2.0;
        }
        let undamped = self
            .reduction
            .solve(&self.columns, 0.0, self.settings.rank_tolerance)?;
        let promised = self.cost - undamped.residual_square;
        Ok(Outcome::Stop(self.stuck(promised)))
    }

    /// No trial lowered the cost: at a minimum the promise itself is only rounding.
    fn stuck(&self, promised: f64) -> Convergence {
        const ROUNDING: f64 = 1e-9;
        if promised <= ROUNDING * self.cost {
            Convergence::SmallCostChange
        } else {
            Convergence::NoFurtherDescent
        }
    }

    /// Residuals are model minus measurement, so the step is subtracted.
    fn trial(&self, step: &[f64], factor: f64) -> Vec<f64> {
        let mut trial = self.parameters.clone();
        for (&index, change) in self.free.iter().zip(step) {
            trial[index] -= factor * change;
        }
        trial
    }

    /// The cost at a trial point; none where the model has no finite value.
    fn trial_cost(&mut self, trial: &[f64]) -> Option<f64> {
        self.evaluations += 1;
        self.problem
            .evaluate(trial, &mut self.trial_residuals, None)
            .ok()?;
        let cost = sum_of_squares(&self.trial_residuals);
        cost.is_finite().then_some(cost)
    }

    fn is_small(&self, step: &[f64], factor: f64) -> bool {
        // 1e-3: a millimetre or a milliradian, so that parameters near zero can converge too.
        self.free.iter().zip(step).all(|(&index, change)| {
            (factor * change).abs()
                <= self.settings.step_tolerance * (self.parameters[index].abs() + 1e-3)
        })
    }

    fn accept(&mut self, trial: Vec<f64>, cost: f64) -> Result<(), IdentificationError> {
        self.problem.evaluate(
            &trial,
            &mut self.residuals,
            Some((self.free, &mut self.jacobian)),
        )?;
        self.evaluations += 1;
        self.reduction = Reduction::new(&self.jacobian, &self.residuals)?;
        self.parameters = trial;
        self.cost = cost;
        Ok(())
    }
}

pub(crate) fn sum_of_squares(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}
