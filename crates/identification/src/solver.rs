//! Gauss-Newton and Levenberg-Marquardt on one QR reduction per iterate.

use haptical_linalg::{Reduction, Solution};

use crate::problem::check_free;
use crate::search::curvature::{Curvature, Normal};
use crate::search::state::Search;
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
    /// Whether it stopped as one that is only compared ([`Settings::to_compare`]).
    pub is_coarse: bool,
    /// The linearised problem at the solution, over the free parameters in their order.
    pub reduction: Reduction,
}

/// Shortest Gauss-Newton step, and strongest damping steps, that are tried before giving up.
const MAX_HALVINGS: usize = 30;

/// Share of an earlier column norm that still weighs in the damping one step later. Without memory a
/// parameter that loses its effect leaps away (NIST's BoxBOD, MGH17); with an endless one, which is
/// Moré's, a wild start slows every later step. The second is tried where the first finds no minimum:
/// Brown & Dennis' function from far is such a case (docs/evidence/solver.md).
const FORGETTING: [f64; 2] = [0.8, 1.0];

/// Damping beyond which a step is too short to halve the promise of the undamped one.
const HOPELESS_DAMPING: f64 = 1e3;

/// Promised fall, as a share of the cost, below which a search begins close to a minimum, and its first damping there. That of
/// [`Settings::initial_damping`] would hold back a weak direction until it has fallen by a third a step.
const CLOSE: f64 = 0.01;
const WEAK_DAMPING: f64 = 1e-12;

/// Above zero, so that the damping can grow again.
const WEAKEST_DAMPING: f64 = 1e-30;

/// Keeps a parameter that has lost its effect on the way finite in the damped problem.
const HEAVIEST_WEIGHT: f64 = 1e100;

/// Steps after which a search is slow: residuals that stay large then have a say in its steps ([`Curvature`]).
const SLOW: usize = 16;

/// Damped steps with the curvature of large residuals that are tried before one without it.
const MAX_CURVED: usize = 6;

/// Minimises the problem over the parameters `free`, from `start`.
///
/// Steps come from a pivoted QR of the scaled derivative matrix, not from normal equations; steps of a slow search that count second
/// derivatives too come from the second derivatives as a whole, and where they end is decided by the QR.
/// Gauss-Newton halves a step that raises the cost; Levenberg-Marquardt adapts its damping by
/// Nielsen's rule (Madsen, Nielsen & Tingleff 2004, section 3.2) and scales it by the largest
/// column norms met lately (Moré 1978, section 6, keeps the largest of all). Both stop where the
/// undamped step promises nothing more: a short step is no sign of a minimum.
///
/// # Errors
/// [`IdentificationError`] for shapes, settings, fewer residuals than free parameters or a model
/// that cannot be evaluated at the start, or a request to stop ([`Settings::interrupt`]). A search that stops early is not an error:
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
    let first = attempt(problem, start, free, settings, FORGETTING[0])?;
    let is_stuck = matches!(
        first.convergence,
        Convergence::IterationLimit | Convergence::NoFurtherDescent
    );
    if settings.method == Method::GaussNewton || !is_stuck {
        return Ok(first);
    }
    // one that was still on its way goes on
    let start = match first.convergence {
        Convergence::IterationLimit => &first.parameters,
        _ => start,
    };
    let mut second = attempt(problem, start, free, settings, FORGETTING[1])?;
    if !second.convergence.was_successful() && first.cost <= second.cost {
        return Ok(first);
    }
    second.evaluations += first.evaluations;
    if first.convergence == Convergence::IterationLimit {
        second.iterations += first.iterations;
    }
    Ok(second)
}

fn attempt<P: Problem + ?Sized>(
    problem: &P,
    start: &[f64],
    free: &[usize],
    settings: &Settings,
    forgetting: f64,
) -> Result<Fit, IdentificationError> {
    let mut search = Search::new(problem, start, free, settings)?;
    let mut damping = Damping {
        value: settings.initial_damping,
        growth: 2.0,
        least_tightened: 0.0,
        norms: vec![0.0; free.len()],
        forgetting,
    };
    let mut iterations = 0;
    let mut curvature: Option<(Curvature, Normal)> = None;
    let mut is_coarse = false;
    let convergence = loop {
        settings.interrupt.check()?;
        let newton = search.newton()?;
        if let Some(reason) = search.converged(&newton) {
            break reason;
        }
        is_coarse = settings.least_fall.is_some() && search.is_near(&newton);
        if is_coarse {
            break search.unless_rank_lost(&newton, Convergence::SmallCostChange);
        }
        if iterations == 0 && newton.explained_square < CLOSE * search.cost {
            damping.least_tightened = damping.value;
            damping.value = damping.value.min(WEAK_DAMPING);
        }
        if iterations == settings.max_iterations {
            break Convergence::IterationLimit;
        }
        let before = (search.cost, search.parameters.clone());
        let moved = match settings.method {
            Method::GaussNewton if newton.rank < free.len() => break Convergence::RankLost,
            Method::GaussNewton => search.gauss_newton(&newton)?,
            Method::LevenbergMarquardt => {
                let curved = curvature.as_ref().filter(|known| known.0.is_closer());
                let is_there = match curved {
                    Some(curved) => search.curved(&newton, &mut damping, curved)?,
                    None => false,
                };
                is_there || search.levenberg_marquardt(&newton, &mut damping)?
            }
        };
        if !moved {
            break search.stuck(&newton);
        }
        iterations += 1;
        if iterations < SLOW {
            continue;
        }
        let fall = before.0 - search.cost;
        is_coarse = settings
            .least_fall
            .is_some_and(|share| fall < share * search.cost);
        if is_coarse {
            break search.unless_rank_lost(&newton, Convergence::SmallCostChange);
        }
        if settings.method == Method::LevenbergMarquardt {
            curvature = Some(search.learned(curvature.take(), before)?);
        }
    };
    let (cost, evaluations) = (search.cost, search.evaluations);
    let (parameters, residuals, reduction) = search.into_parts()?;
    Ok(Fit {
        parameters,
        cost,
        residuals,
        iterations,
        evaluations,
        convergence,
        is_coarse,
        reduction,
    })
}

struct Damping {
    value: f64,
    growth: f64,
    /// Least damping after a step that was no improvement, of a search that began with a weak one.
    least_tightened: f64,
    /// Largest norm of each column, fading.
    norms: Vec<f64>,
    forgetting: f64,
}

impl<P: Problem + ?Sized> Search<'_, P> {
    fn gauss_newton(&mut self, newton: &Solution) -> Result<bool, IdentificationError> {
        let mut factor = 1.0;
        for _ in 0..MAX_HALVINGS {
            let trial = self.trial(&newton.values, factor);
            if self.try_move(trial, newton)? {
                return Ok(true);
            }
            factor *= 0.5;
        }
        Ok(false)
    }

    fn levenberg_marquardt(
        &mut self,
        newton: &Solution,
        damping: &mut Damping,
    ) -> Result<bool, IdentificationError> {
        let weights = damping.weights(self.column_norms());
        for _ in 0..MAX_HALVINGS {
            let step = self.damped(damping.value, &weights)?;
            let before = self.cost;
            let trial = self.trial(&step.values, 1.0);
            if self.try_move(trial, newton)? {
                damping.relax((before - self.cost) / step.explained_square);
                return Ok(true);
            }
            // of the promise, a step damped so much keeps at most 2 n / damping: here less than the cost's rounding
            let kept = newton.explained_square * weights.len() as f64 / damping.value;
            if damping.value > HOPELESS_DAMPING && kept <= f64::EPSILON * self.cost {
                break;
            }
            damping.tighten();
        }
        Ok(false)
    }

    /// A damped step with the curvature of large residuals; false where none of a few is an improvement.
    fn curved(
        &mut self,
        newton: &Solution,
        damping: &mut Damping,
        (curvature, here): &(Curvature, Normal),
    ) -> Result<bool, IdentificationError> {
        let weights = damping.weights(self.column_norms());
        let first = (damping.value, damping.growth);
        for _ in 0..MAX_CURVED {
            let before = self.cost;
            if let Some((step, promise)) = curvature.step(here, damping.value, &weights) {
                let trial = self.trial(&step, 1.0);
                if self.try_move(trial, newton)? {
                    damping.relax((before - self.cost) / promise);
                    return Ok(true);
                }
            }
            damping.tighten();
        }
        (damping.value, damping.growth) = first;
        Ok(false)
    }

    /// What a step from `before` says of the curvature, with the normal equations where it ended.
    fn learned(
        &self,
        known: Option<(Curvature, Normal)>,
        (cost, parameters): (f64, Vec<f64>),
    ) -> Result<(Curvature, Normal), IdentificationError> {
        let here = self.normal()?;
        let Some((mut curvature, there)) = known else {
            return Ok((Curvature::new(self.free.len()), here));
        };
        let step = self.free.iter();
        let step: Vec<f64> = step.map(|&k| self.parameters[k] - parameters[k]).collect();
        curvature.learn(&step, cost - self.cost, [&there, &here]);
        Ok((curvature, here))
    }
}

impl Damping {
    /// Weights of the columns, from the largest of their norms, which fade.
    fn weights(&mut self, norms: &[f64]) -> Vec<f64> {
        let mut weights = vec![1.0; norms.len()];
        for ((largest, norm), weight) in self.norms.iter_mut().zip(norms).zip(&mut weights) {
            *largest = (self.forgetting * *largest).max(*norm);
            if *norm > 0.0 {
                *weight = (*largest / norm).min(HEAVIEST_WEIGHT);
            }
        }
        weights
    }

    /// After a step that fell by `gain` times what it promised.
    fn relax(&mut self, gain: f64) {
        // Near the minimum the fall is rounding, and so would the gain be.
        let gain = if gain.is_finite() {
            gain.clamp(0.0, 1.0)
        } else {
            1.0
        };
        self.value *= (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0);
        self.value = self.value.max(WEAKEST_DAMPING);
        self.growth = 2.0;
    }

    /// After a step that was no improvement.
    fn tighten(&mut self) {
        self.value = (self.value * self.growth).max(self.least_tightened);
        self.growth *= 2.0;
    }
}
