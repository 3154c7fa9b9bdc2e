//! Base model and causes together as one least-squares problem, and the search for its minimum.

use std::cell::Cell;
use std::sync::Arc;

use haptical_effects::{Context, Effect, Shape, Signal};
use haptical_identification::{
    Convergence, Fit, IdentificationError, Matrix, Reduction, Settings, Triangle, TriangleProblem,
    solve,
};
use haptical_linalg::{Direction, OrthonormalBasis, RANK_TOLERANCE, SparseColumns};

use crate::DiagnosisError;
use crate::engine::base::Base;
use crate::engine::base_problem::BaseProblem;
use crate::engine::model::{Cause, Model, Refit};
use crate::engine::part::{Part, across, dense};
use crate::engine::system::{compress_columns, compress_rows, dot};
use crate::engine::with_causes;
use crate::thresholds::fit::{LEAST_FALL, PASSES};

/// What a fit of base model and causes is made of.
#[derive(Clone, Copy)]
pub(crate) struct Fitting<'r> {
    pub(crate) context: &'r Context<'r>,
    pub(crate) problem: &'r BaseProblem<'r>,
    pub(crate) base: &'r Base,
    pub(crate) effects: &'r [Box<dyn Effect>],
    /// The rows that it sees.
    pub(crate) part: &'r Part,
}

impl Fitting<'_> {
    /// Searches the minimum from `model` by Levenberg-Marquardt, with the derivatives of base model and causes at every step.
    pub(crate) fn descend(&self, model: &Model) -> Result<Refit, DiagnosisError> {
        let together = Together {
            fitting: self,
            start: model,
            owners: owners(self.effects, &model.causes),
            lowest: Cell::new(f64::INFINITY),
        };
        let start = together.numbers();
        if start.is_empty() {
            let residual = with_causes(model.bare.to_vec(), self.context, self.effects, &[]);
            return Ok(Refit {
                model: model.clone(),
                residual,
                covariance: None,
                promised: 0.0,
                convergence: Convergence::SmallCostChange,
                last_step: 0.0,
            });
        }
        let rows = self.part.blocks.count();
        let freedom = rows.saturating_sub(start.len()).max(1) as f64;
        let settings = Settings {
            max_iterations: PASSES,
            cost_tolerance: LEAST_FALL / freedom,
            rank_tolerance: RANK_TOLERANCE,
            interrupt: self.base.interrupt.clone(),
            ..Settings::default()
        };
        let all: Vec<usize> = (0..start.len()).collect();
        let fit = solve(&together, &start, &all, &settings)?;
        self.refit_of(&together, fit, freedom)
    }

    fn refit_of(
        &self,
        together: &Together<'_>,
        fit: Fit,
        freedom: f64,
    ) -> Result<Refit, DiagnosisError> {
        let all: Vec<usize> = (0..fit.parameters.len()).collect();
        let newton = fit.reduction.solve(&all, 0.0, RANK_TOLERANCE)?;
        let promised = newton.explained_square;
        let mut model = together.model_at(&fit.parameters);
        let bare = self.problem.evaluate(&model.values, false)?.residual;
        model.bare = Arc::new(bare);
        let bare = model.bare.to_vec();
        let residual = with_causes(bare, self.context, self.effects, &model.causes);
        // directions that the rows do not fix are left where they are: the others are at their minimum all the same
        let convergence = match has_settled(promised, fit.cost, freedom) {
            true => Convergence::SmallCostChange,
            false => fit.convergence,
        };
        Ok(Refit {
            model,
            residual,
            covariance: covariance(&fit.reduction, self.base.free.len()),
            promised,
            convergence,
            last_step: (promised / self.part.blocks.count().max(1) as f64).sqrt(),
        })
    }
}

/// Whether the fall of the cost that the linearised problem promises is below a hundredth of the variance of what is left, or of
/// the noise where that is more: every number is then within a tenth of its standard deviation of the minimum.
pub(crate) fn has_settled(promised: f64, cost: f64, freedom: f64) -> bool {
    promised <= LEAST_FALL * (cost / freedom).max(1.0)
}

/// Covariance of the numbers behind the first `base`, for noise of unit size; none where they depend on each other.
fn covariance(reduction: &Reduction, base: usize) -> Option<Matrix> {
    let count = reduction.columns();
    if base == count {
        return None;
    }
    let all: Vec<usize> = (0..count).collect();
    let factor = reduction
        .scaled_factor(&all, reduction.column_norms())
        .ok()?;
    let column = |index: usize| factor.column(index).to_vec();
    let free: Vec<Direction> = (0..base)
        .map(|index| Direction::new(column(index)))
        .collect();
    let free = (base > 0).then(|| SparseColumns::new(factor.rows(), free));
    let basis = free.map(|free| OrthonormalBasis::new(&free, RANK_TOLERANCE));
    let basis = basis.transpose().ok()?;
    let projected: Vec<Vec<f64>> = (base..count)
        .map(|index| across(basis.as_ref(), &column(index)))
        .collect();
    let matrix = Matrix::from_fn(factor.rows(), projected.len(), |row, column| {
        projected[column][row]
    });
    let own = Reduction::new(&matrix, &vec![0.0; factor.rows()]).ok()?;
    let all: Vec<usize> = (0..projected.len()).collect();
    own.covariance(&all, RANK_TOLERANCE).ok()
}

/// Base model and causes on the rows of a part: first the free parameters, then the causes' numbers.
struct Together<'r> {
    fitting: &'r Fitting<'r>,
    start: &'r Model,
    owners: Vec<Owner>,
    /// Lowest cost since the search was at its start.
    lowest: Cell<f64>,
}

impl Together<'_> {
    /// The numbers of the start.
    fn numbers(&self) -> Vec<f64> {
        let free = self.fitting.base.free.iter();
        let of_base = free.map(|&parameter| self.start.values[parameter]);
        let of_cause = |owner: &Owner| match *owner {
            Owner::Amplitude(cause, amplitude) => self.start.causes[cause].amplitudes[amplitude],
            Owner::LogShape(_) => 0.0,
        };
        of_base.chain(self.owners.iter().map(of_cause)).collect()
    }

    /// The model with other numbers; its residuals without causes are still those of the start.
    fn model_at(&self, numbers: &[f64]) -> Model {
        let mut model = self.start.clone();
        let (of_base, of_causes) = numbers.split_at(self.fitting.base.free.len());
        for (&parameter, number) in self.fitting.base.free.iter().zip(of_base) {
            model.values[parameter] = *number;
        }
        for (owner, number) in self.owners.iter().zip(of_causes) {
            match *owner {
                Owner::Amplitude(cause, amplitude) => {
                    model.causes[cause].amplitudes[amplitude] = *number;
                }
                Owner::LogShape(cause) => model.causes[cause].shape *= number.exp(),
            }
        }
        model
    }
}

impl TriangleProblem for Together<'_> {
    fn columns(&self) -> usize {
        self.fitting.base.free.len() + self.owners.len()
    }

    fn reduce_into(
        &self,
        parameters: &[f64],
        free: &[usize],
        into: &mut Triangle,
    ) -> Result<(), IdentificationError> {
        let Fitting {
            context,
            problem,
            base,
            effects,
            part,
        } = *self.fitting;
        let model = self.model_at(parameters);
        let evaluate = |derivatives: bool| {
            let evaluated = problem.evaluate(&model.values, derivatives);
            evaluated.map_err(|error| match error {
                DiagnosisError::Identification(error) => error,
                other => IdentificationError::Evaluation {
                    reason: other.to_string(),
                },
            })
        };
        let whitened = |bare: Vec<Vec<f64>>| {
            let rest = with_causes(bare, context, effects, &model.causes);
            let mut residuals = compress_rows(&part.blocks, &rest);
            residuals.extend(base.pull(&model.values));
            // model minus measurement
            residuals.iter_mut().for_each(|value| *value = -*value);
            residuals
        };
        let is_start = parameters == self.numbers();
        if !is_start {
            let residuals = whitened(evaluate(false)?.residual);
            if dot(&residuals, &residuals) > self.lowest.get() {
                // no way leads on from here: it needs no derivatives
                let nothing = vec![0.0; residuals.len()];
                let columns = vec![nothing.as_slice(); free.len()];
                return Ok(into.fold_rows(&columns, &residuals)?);
            }
        }
        let evaluated = evaluate(true)?;
        let residuals = whitened(evaluated.residual);
        self.lowest.set(dot(&residuals, &residuals));
        let rows = part.blocks.count();
        let mut columns = Vec::with_capacity(self.columns());
        if let Some(derivatives) = &evaluated.derivatives {
            let free = compress_columns(context, problem, &part.blocks, derivatives, &base.free);
            columns.extend((0..free.columns()).map(|column| free.dense(column)));
        }
        columns.extend(by_cause(self.fitting, &model));
        for (index, column) in columns.iter_mut().enumerate() {
            column.resize(residuals.len(), 0.0);
            if let Some(stiffness) = base.stiffness().get(index) {
                column[rows + index] = *stiffness;
            }
        }
        let chosen: Vec<&[f64]> = free
            .iter()
            .map(|&index| columns[index].as_slice())
            .collect();
        Ok(into.fold_rows(&chosen, &residuals)?)
    }
}

/// Whose number a column of a refit is.
#[derive(Debug, Clone, Copy)]
enum Owner {
    Amplitude(usize, usize),
    /// Logarithm of a shape over that of the start.
    LogShape(usize),
}

fn owners(effects: &[Box<dyn Effect>], causes: &[Cause]) -> Vec<Owner> {
    let of_cause = |(index, cause): (usize, &Cause)| {
        let amplitudes = 0..cause.amplitudes.len();
        let shape = effects[cause.effect].spec().shape;
        amplitudes
            .map(move |amplitude| Owner::Amplitude(index, amplitude))
            .chain(shape.is_continuous().then_some(Owner::LogShape(index)))
    };
    causes.iter().enumerate().flat_map(of_cause).collect()
}

/// Whitened derivatives of all causes' numbers, in the order of their owners.
fn by_cause(fitting: &Fitting<'_>, model: &Model) -> Vec<Vec<f64>> {
    let (context, effects) = (fitting.context, fitting.effects);
    let of_cause = |cause: &Cause| {
        let effect = &effects[cause.effect];
        let mut signals = match effect.spec().shape {
            Shape::Sides if cause.amplitudes.iter().any(|own| *own != 0.0) => {
                by_differences(cause, effects, context)
            }
            _ => cause.derivative(effects, context),
        };
        if effect.spec().shape.is_continuous() {
            let step = effect.shape_step(context, cause.shape);
            let at = |shape: f64| effect.signal(context, &cause.amplitudes, shape);
            let higher = at(cause.shape * (1.0 + step));
            signals.push(difference(
                &higher,
                &at(cause.shape * (1.0 - step)),
                2.0 * step,
            ));
        }
        signals
    };
    let signals = model.causes.iter().flat_map(of_cause);
    signals.map(|signal| dense(fitting.part, &signal)).collect()
}

/// Change of a play per change of its width: its column, the output per width, is another one while the play is crossed.
fn by_differences(
    cause: &Cause,
    effects: &[Box<dyn Effect>],
    context: &Context<'_>,
) -> Vec<Signal> {
    let of_amplitude = |index: usize| {
        let step = WIDTH_STEP * cause.amplitudes[index].abs().max(f64::MIN_POSITIVE);
        let moved = |change: f64| {
            let mut moved = cause.clone();
            moved.amplitudes[index] += change;
            moved.contribution(effects, context)
        };
        difference(&moved(step), &moved(-step), 2.0 * step)
    };
    (0..cause.amplitudes.len()).map(of_amplitude).collect()
}

/// Step of a width over the width itself: more than what a reversal at a row makes it, so that rows that are crossed together count
/// together.
const WIDTH_STEP: f64 = 0.01;

fn difference(higher: &Signal, lower: &Signal, step: f64) -> Signal {
    let mut slope = Signal::default();
    slope.add(higher, 1.0 / step);
    slope.add(lower, -1.0 / step);
    slope
}
