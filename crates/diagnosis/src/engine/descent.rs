//! Base model, alone or with causes, as one least-squares problem, and the search for its minimum.

use std::sync::Arc;

use haptical_calibration::Weights;
use haptical_identification::{Convergence, Fit, Matrix, Settings, solve};
use haptical_linalg::RANK_TOLERANCE;

use super::prepared::BaseFit;
use super::sampled::Samples;
use super::whitened::{Fitting, Whitened};
use crate::Result;
use crate::engine::{Base, BaseProblem, Blocks, Model, Part, Prepared, Refit, square, with_causes};
use crate::noise::KnownNoise;
use crate::thresholds::fit::{
    BASE_PASSES, COMPARED, FAR_SD, LEAST_FALL, PASSES, ROUNDS, SAMPLED_S, STILL_SD,
};

impl Fitting<'_> {
    /// The minimum from `model` on. A base model that has made up for a cause lies far away from the one with the cause, at the end of a
    /// bent valley: where the causes as they were scanned raise what the base model leaves, and that is much, the search begins with the
    /// links of the device file.
    pub(crate) fn descend(&self, model: &Model) -> Result<Refit> {
        let Some(described) = self.described(model) else {
            return self.search(model);
        };
        // where the device of the file has no value there is no search from there
        let found = self.bared(described).and_then(|from| self.search(&from));
        let found = match found {
            Ok(found) if found.has_converged() => return Ok(found),
            other => other,
        };
        let other = self.search(model)?;
        Ok(match found {
            Ok(found) if self.cost(&found) <= self.cost(&other) => found,
            _ => other,
        })
    }

    /// A model far away, with the links of the device file.
    fn described(&self, model: &Model) -> Option<Model> {
        let base = self.data.base;
        if model.causes.is_empty() || base.described.is_empty() {
            return None;
        }
        let left = with_causes(
            model.bare.to_vec(),
            &self.data.context,
            self.effects,
            &model.causes,
        );
        let pull = base.pull(&model.values);
        let cost = square(self.part, &left, &pull);
        let numbers = base.free.len() + model.causes.len();
        let is_far = cost > FAR_SD * FAR_SD * self.freedom(numbers)
            && cost > square(self.part, &model.bare, &pull);
        is_far.then(|| {
            let mut described = model.clone();
            let free = |(place, _): &&(usize, f64)| base.free.contains(place);
            for &(place, value) in base.described.iter().filter(free) {
                described.values[place] = value;
            }
            described
        })
    }

    fn cost(&self, refit: &Refit) -> f64 {
        square(
            self.part,
            &refit.residual,
            &self.data.base.pull(&refit.model.values),
        )
    }

    /// The search of every fit ([`solve`]), until the linearised problem promises next to nothing.
    fn search(&self, model: &Model) -> Result<Refit> {
        let data = self.data;
        let context = &data.context;
        let (streams, rows) = (context.streams.len(), context.rows());
        let samples = Samples::new(&self.part.blocks, streams, rows, data.sampled_rows());
        let selected = samples.rows.as_ref().map(|rows| data.problem.select(rows));
        let at_samples = match &selected {
            None => None,
            Some((readings, postures)) => {
                let postures = postures.as_ref().unwrap_or(readings);
                let weights = Weights::stated(&data.base.device, &data.base.channels);
                let (base, streams) = (data.base, &context.streams);
                Some(BaseProblem::new(
                    base, readings, postures, streams, &weights,
                )?)
            }
        };
        let problem = at_samples.as_ref().unwrap_or(&data.problem);
        let mut here = model.clone();
        let mut round = 0;
        loop {
            let whitened = Whitened::new(self, &here, (&samples, problem))?;
            let Some(fit) = self.solved(&whitened)? else {
                return Ok(self.refit(here));
            };
            let is_through = samples.rows.is_none() || fit.is_coarse || fit.iterations == 0;
            round += 1;
            let next = self.bared(whitened.model(&fit.parameters))?;
            if is_through || round == ROUNDS {
                return self.found(next, &fit);
            }
            here = next;
        }
    }

    /// The minimum of a problem; none where it has no number.
    fn solved(&self, problem: &Whitened<'_>) -> Result<Option<Fit>> {
        let start = problem.start();
        let free: Vec<usize> = (0..start.len()).collect();
        if free.is_empty() {
            return Ok(None);
        }
        let settings = Settings {
            max_iterations: PASSES,
            cost_tolerance: LEAST_FALL / self.freedom(free.len()),
            least_promise: Some(LEAST_FALL),
            rank_tolerance: RANK_TOLERANCE,
            interrupt: self.data.base.interrupt.clone(),
            ..Settings::default()
        };
        // without causes it is only compared
        let is_alone = start.len() == self.data.base.free.len();
        let settings = Settings {
            least_fall: self.least_fall.or(is_alone.then_some(COMPARED)),
            ..settings
        };
        Ok(Some(solve(problem, &start, &free, &settings)?))
    }

    /// The end of a search, with what its linearised problem says of the causes.
    fn found(&self, model: Model, fit: &Fit) -> Result<Refit> {
        let free: Vec<usize> = (0..fit.reduction.columns()).collect();
        let causes = self.data.base.free.len();
        let last = fit.reduction.solve(&free, 0.0, RANK_TOLERANCE)?;
        let covariance = fit.reduction.covariance(&free, RANK_TOLERANCE).ok();
        let of_causes = covariance.filter(|_| causes < free.len()).map(|all| {
            let count = free.len() - causes;
            Matrix::from_fn(count, count, |row, column| {
                all[(causes + row, causes + column)]
            })
        });
        let variance = (fit.cost / self.freedom(free.len())).max(1.0);
        let sd = |index: usize| Some((of_causes.as_ref()?[(index, index)] * variance).sqrt());
        let mut changes = last.values[causes..].iter().enumerate();
        let are_causes_still = of_causes.is_some()
            && changes
                .all(|(index, change)| sd(index).is_some_and(|sd| change.abs() <= STILL_SD * sd));
        let convergence = match fit.convergence {
            // what is left along a direction that no row fixes
            Convergence::RankLost => Convergence::SmallCostChange,
            // a valley of the base model, along which no cause changes
            reason if !reason.was_successful() && are_causes_still => Convergence::SmallCostChange,
            reason => reason,
        };
        Ok(Refit {
            promised: last.explained_square,
            last_step: (last.explained_square / self.part.blocks.count().max(1) as f64).sqrt(),
            covariance: of_causes,
            convergence,
            ..self.refit(model)
        })
    }

    /// A model of which the residuals without causes are known, as the end of a search.
    fn refit(&self, model: Model) -> Refit {
        let bare = model.bare.to_vec();
        Refit {
            residual: with_causes(bare, &self.data.context, self.effects, &model.causes),
            model,
            covariance: None,
            promised: 0.0,
            convergence: Convergence::SmallCostChange,
            last_step: 0.0,
        }
    }

    /// A model with its residuals without causes.
    fn bared(&self, mut model: Model) -> Result<Model> {
        let bare = self.data.problem.evaluate(&model.values, false)?;
        model.bare = Arc::new(bare.residual);
        Ok(model)
    }

    fn freedom(&self, numbers: usize) -> f64 {
        self.part.blocks.count().saturating_sub(numbers).max(1) as f64
    }
}

/// Whether the fall of the cost that the linearised problem promises is below a hundredth of the variance of what is left, or of
/// the noise where that is more: every number is then within a tenth of its standard deviation of the minimum.
pub(crate) fn has_settled(promised: f64, cost: f64, freedom: f64) -> bool {
    promised <= LEAST_FALL * (cost / freedom).max(1.0)
}

impl Prepared<'_> {
    /// Rows of which a search works out the base model at one.
    fn sampled_rows(&self) -> usize {
        let row_s = self.context.moving_s() / self.context.rows().max(1) as f64;
        match self.context.ordered && row_s > 0.0 {
            true => ((SAMPLED_S / row_s) as usize).max(1),
            false => 1,
        }
    }

    /// Fits the base model; the noise is estimated anew where the start was far from it.
    pub(super) fn base_fit(
        &self,
        (mut values, mut residual): (Vec<f64>, Vec<Vec<f64>>),
        known: Option<&KnownNoise>,
    ) -> Result<BaseFit> {
        let mut pass = 0;
        loop {
            let known = known.cloned().unwrap_or_else(|| self.noise_of(&residual));
            let blocks = Blocks::new(&self.context, &self.usable, &self.own, &known);
            let whole = self.part_of(blocks, self.derivatives.as_ref())?;
            let evaluate = |values: &[f64]| Ok(self.problem.evaluate(values, false)?.residual);
            let mut fit = nearby(&whole, self.base, (values, residual), &evaluate)?;
            let is_near = fit.has_converged();
            // where the calibration's own search found no minimum, another one leads away from what causes can mend
            if !is_near && self.base.unfinished.is_none() {
                // the derivatives of the start may not lead to the minimum
                let found = Fitting {
                    data: self,
                    effects: &[],
                    part: &whole,
                    least_fall: Some(COMPARED),
                };
                let found = found.descend(&fit.model)?;
                fit = if found.has_converged() { found } else { fit };
            }
            pass += 1;
            // a start far away has shown noise that is partly the way's
            if pass > 1 || is_near {
                return Ok(BaseFit { known, whole, fit });
            }
            (values, residual) = (fit.model.values, fit.residual);
        }
    }
}

/// Residuals of the base model at its values, per stream and row.
type Evaluate<'e> = dyn Fn(&[f64]) -> Result<Vec<Vec<f64>>> + 'e;

/// The base model's minimum by Gauss-Newton with the derivatives of a part, from values and their residuals: a few steps with one
/// decomposition, as long as the cost falls.
pub(crate) fn nearby(
    part: &Part,
    base: &Base,
    (values, residual): (Vec<f64>, Vec<Vec<f64>>),
    evaluate: &Evaluate<'_>,
) -> Result<Refit> {
    let rows = part.blocks.count() as f64;
    let freedom = (rows - base.free.len() as f64).max(1.0);
    let mut near = Refit {
        model: Model {
            values,
            bare: Arc::default(),
            causes: Vec::new(),
        },
        residual,
        covariance: None,
        promised: 0.0,
        convergence: Convergence::IterationLimit,
        last_step: 0.0,
    };
    let mut cost = square(part, &near.residual, &base.pull(&near.model.values));
    for _ in 0..=BASE_PASSES {
        base.interrupt.check()?;
        let Some((step, promised)) =
            part.base_step(&near.residual, &base.pull(&near.model.values))?
        else {
            near.convergence = Convergence::SmallCostChange;
            break;
        };
        near.promised = promised;
        near.last_step = (promised / rows.max(1.0)).sqrt();
        if has_settled(promised, cost, freedom) {
            near.convergence = Convergence::SmallCostChange;
            break;
        }
        let mut next = near.model.values.clone();
        base.step(&mut next, &step, 1.0);
        let Ok(rest) = evaluate(&next) else { break };
        let less = square(part, &rest, &base.pull(&next));
        if less.is_nan() || less >= cost {
            break;
        }
        (near.model.values, near.residual, cost) = (next, rest, less);
    }
    near.model.bare = Arc::new(near.residual.clone());
    Ok(near)
}
