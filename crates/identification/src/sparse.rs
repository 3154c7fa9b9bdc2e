//! Gauss-Newton on faer's sparse QR, for problems whose derivative matrix is mostly zero.

use haptical_linalg::{LinalgError, SparseLeastSquares};

use crate::problem::{by_parameter, check_free};
use crate::search::{SMALLEST_SCALE, UNSEEN_FALL, UNSEEN_STEP, sum_of_squares};
use crate::solver::MAX_HALVINGS;
use crate::{Convergence, IdentificationError, Settings, SparseProblem};

/// The outcome of a sparse fit.
#[derive(Debug, Clone, PartialEq)]
pub struct SparseFit {
    /// All parameters; those that were not free keep their start.
    pub parameters: Vec<f64>,
    /// Sum of squared (weighted) residuals.
    pub cost: f64,
    /// Accepted steps.
    pub iterations: usize,
    /// Why the search stopped.
    pub convergence: Convergence,
}

/// Minimises the problem over `free` by Gauss-Newton with sparse QR steps, halved where the cost
/// would rise. The pattern is analysed once. The rank must have been decided before (see
/// [`crate::analyse`]): dependent parameters are refused, never silently solved.
///
/// # Errors
/// As [`crate::solve`], and [`IdentificationError::RankDeficient`].
pub fn solve_sparse<P: SparseProblem + ?Sized>(
    problem: &P,
    start: &[f64],
    free: &[usize],
    settings: &Settings,
) -> Result<SparseFit, IdentificationError> {
    settings.check()?;
    check_free(problem, start, free)?;
    let rows = problem.residual_count();
    if rows < free.len() {
        return Err(IdentificationError::TooFewRows {
            rows,
            parameters: free.len(),
        });
    }
    let named = |error: LinalgError| by_parameter(error.into(), problem, free);
    let mut parameters = start.to_vec();
    let mut residuals = vec![0.0; rows];
    let mut trial_residuals = vec![0.0; rows];
    let mut entries = Vec::new();
    problem.evaluate_sparse(&parameters, free, &mut residuals, &mut entries)?;
    let solver = SparseLeastSquares::new(rows, free.len(), &entries)?;
    let mut cost = sum_of_squares(&residuals);
    let mut iterations = 0;
    // promise of the step before, where the fall of the cost cannot be seen any more
    let mut unseen_before = f64::INFINITY;
    let convergence = loop {
        let step = solver.solve(&entries, &residuals).map_err(named)?;
        let promised = explained(&entries, &residuals, &step);
        if cost == 0.0 {
            break Convergence::ExactFit;
        }
        if promised <= settings.cost_tolerance * cost {
            break Convergence::SmallCostChange;
        }
        let small = |tolerance: f64| {
            free.iter().zip(&step).all(|(&index, change)| {
                change.abs() <= tolerance * (parameters[index].abs() + SMALLEST_SCALE)
            })
        };
        if small(settings.step_tolerance) {
            break Convergence::SmallStep;
        }
        if iterations == settings.max_iterations {
            break Convergence::IterationLimit;
        }
        // Where the fall drowns in the cost's rounding, steps count as long as each halves the promise.
        let unseen = promised <= UNSEEN_FALL * cost;
        if unseen && promised > 0.5 * unseen_before {
            break Convergence::SmallCostChange;
        }
        if unseen {
            unseen_before = promised;
        }
        let highest = if unseen {
            (1.0 + UNSEEN_FALL) * cost
        } else {
            cost
        };
        let mut factor = 1.0;
        let mut accepted = None;
        for _ in 0..MAX_HALVINGS {
            let mut trial = parameters.clone();
            for (&index, change) in free.iter().zip(&step) {
                trial[index] -= factor * change;
            }
            if problem.evaluate(&trial, &mut trial_residuals, None).is_ok() {
                let trial_cost = sum_of_squares(&trial_residuals);
                // A NaN is refused.
                if trial_cost < highest {
                    accepted = Some((trial, trial_cost));
                    break;
                }
            }
            factor *= 0.5;
        }
        let Some((trial, trial_cost)) = accepted else {
            break if unseen {
                Convergence::SmallCostChange
            } else if small(UNSEEN_STEP) {
                Convergence::SmallStep
            } else {
                Convergence::NoFurtherDescent
            };
        };
        parameters = trial;
        cost = trial_cost;
        iterations += 1;
        problem.evaluate_sparse(&parameters, free, &mut residuals, &mut entries)?;
    };
    Ok(SparseFit {
        parameters,
        cost,
        iterations,
        convergence,
    })
}

/// |r|^2 - |r - A x|^2 without the cancellation of that subtraction.
fn explained(entries: &[crate::Triplet], residuals: &[f64], step: &[f64]) -> f64 {
    let mut fitted = vec![0.0; residuals.len()];
    for entry in entries {
        fitted[entry.row] += entry.value * step[entry.column];
    }
    fitted
        .iter()
        .zip(residuals)
        .map(|(fit, have)| fit * (2.0 * have - fit))
        .sum()
}
