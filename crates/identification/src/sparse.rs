//! Gauss-Newton on faer's sparse QR, for problems whose derivative matrix is mostly zero.

use haptical_linalg::SparseLeastSquares;

use crate::problem::check_free;
use crate::solver::sum_of_squares;
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
    let mut parameters = start.to_vec();
    let mut residuals = vec![0.0; rows];
    let mut trial_residuals = vec![0.0; rows];
    let mut entries = Vec::new();
    problem.evaluate_sparse(&parameters, free, &mut residuals, &mut entries)?;
    let solver = SparseLeastSquares::new(rows, free.len(), &entries)?;
    let mut cost = sum_of_squares(&residuals);
    let exact_cost = cost * 1e-28;
    let mut iterations = 0;
    let convergence = loop {
        if cost <= exact_cost {
            break Convergence::ExactFit;
        }
        if iterations == settings.max_iterations {
            break Convergence::IterationLimit;
        }
        let step = solver.solve(&entries, &residuals)?;
        let promised = cost - residual_after(&entries, &residuals, &step);
        let last = promised <= settings.cost_tolerance * cost;
        let mut factor = 1.0;
        let mut accepted = None;
        for _ in 0..30 {
            let mut trial = parameters.clone();
            for (&index, change) in free.iter().zip(&step) {
                trial[index] -= factor * change;
            }
            if problem.evaluate(&trial, &mut trial_residuals, None).is_ok() {
                let trial_cost = sum_of_squares(&trial_residuals);
                if trial_cost.is_finite() && trial_cost < cost {
                    accepted = Some((trial, trial_cost));
                    break;
                }
            }
            if last {
                break;
            }
            factor *= 0.5;
        }
        let Some((trial, trial_cost)) = accepted else {
            break if promised <= 1e-9 * cost {
                Convergence::SmallCostChange
            } else {
                Convergence::NoFurtherDescent
            };
        };
        parameters = trial;
        cost = trial_cost;
        iterations += 1;
        if last {
            break Convergence::SmallCostChange;
        }
        problem.evaluate_sparse(&parameters, free, &mut residuals, &mut entries)?;
    };
    Ok(SparseFit {
        parameters,
        cost,
        iterations,
        convergence,
    })
}

/// |r - A x|^2.
fn residual_after(entries: &[crate::Triplet], residuals: &[f64], step: &[f64]) -> f64 {
    let mut rest = residuals.to_vec();
    for entry in entries {
        rest[entry.row] -= entry.value * step[entry.column];
    }
    sum_of_squares(&rest)
}
