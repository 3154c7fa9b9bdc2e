//! Which parameters are fitted: decided at the nominal device, and again at each solution.

use haptical_identification::{Fit, Identifiability, ParameterInfo, Reduction, solve};

use crate::error::wrap;
use crate::fit::free_set::{enough, hold_linearly, judge, supported};
use crate::problem::form::{Prepared, reduce};
use crate::{CalibrationError, Options};

/// Rounds before the set is accepted as it is.
const MAX_ROUNDS: usize = 6;

/// A fit whose parameters are still to be chosen.
pub(super) struct Rounds<'r, 'p> {
    /// Name of the fit in errors.
    pub(super) what: &'r str,
    pub(super) options: &'r Options,
    /// Positions of candidates that the samples do not support.
    pub(super) unsupported: &'r [usize],
    pub(super) prepared: &'r Prepared<'p>,
    pub(super) infos: &'r [ParameterInfo],
    pub(super) nominal: &'r Identifiability,
}

/// The fit of the last round.
pub(super) struct Ended {
    pub(super) fit: Fit,
    /// The fitted parameters, positions within the candidates.
    pub(super) free: Vec<usize>,
    pub(super) identifiability: Identifiability,
    /// The linearised problem over all candidates.
    pub(super) reduction: Reduction,
    /// Steps of all rounds.
    pub(super) iterations: usize,
}

impl Rounds<'_, '_> {
    /// Fits `free` from `values`, and again while the solution asks for another set. Sets are compared by searches that end early; the last
    /// search ends as the request asks.
    pub(super) fn run(
        &self,
        mut values: Vec<f64>,
        mut free: Vec<usize>,
    ) -> Result<Ended, CalibrationError> {
        let (what, options) = (self.what, self.options);
        let wrap = |source| wrap(what, source);
        let problem = self.prepared.problem;
        let (start, searched) = (problem.start(), self.prepared.searched());
        let is_whole = self.unsupported.is_empty();
        let mut iterations = 0;
        let mut met: Vec<Vec<usize>> = Vec::new();
        // where all are fitted at the start, hardly one is dropped at the solution
        let (mut is_kept, mut is_last) = (false, free.len() == values.len());
        loop {
            enough(what, problem, &free, self.nominal, is_whole)?;
            let settings = match is_last {
                true => options.search.clone(),
                false => options.search.to_compare(),
            };
            let mut fit = solve(searched, &values, &free, &settings).map_err(wrap)?;
            let found = fit.parameters.iter_mut().zip(problem.parameters());
            for ((value, parameter), start) in found.zip(&start) {
                *value = parameter.in_nearest_turn(*value, *start);
            }
            iterations += fit.iterations;
            let reduction = reduce(searched, &fit.parameters).map_err(wrap)?;
            let judged = judge(problem, self.infos, &reduction, &free, &options.rules);
            let identifiability = judged.map_err(wrap)?;
            let wanted = supported(&identifiability, self.unsupported);
            values.clone_from(&fit.parameters);
            if met.last() != Some(&free) {
                met.push(free.clone());
            }
            // where no set is stable, the last one is kept with its statuses at the solution
            let is_stable = wanted == free || is_kept || met.len() == MAX_ROUNDS;
            let is_through = is_last || !fit.is_coarse || options.search.least_fall.is_some();
            if is_stable && is_through {
                return Ok(Ended {
                    fit,
                    free,
                    identifiability,
                    reduction,
                    iterations,
                });
            }
            is_last = is_stable;
            if is_stable {
                continue;
            }
            free = match met.iter().position(|set| *set == wanted) {
                None => wanted,
                // they come round again, until the last round
                Some(first) => {
                    is_kept = true;
                    let round = &met[first..];
                    round[(MAX_ROUNDS - 1 - first) % round.len()].clone()
                }
            };
            hold_linearly((searched, &reduction), &mut values, &free, &start);
        }
    }
}
