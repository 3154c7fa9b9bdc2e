//! The base model's own fit to a recording.

use std::sync::Arc;

use haptical_identification::Convergence;

use super::prepared::{BaseFit, Prepared};
use crate::DiagnosisError;
use crate::engine::base::Base;
use crate::engine::blocks::Blocks;
use crate::engine::descent::{Fitting, has_settled};
use crate::engine::model::Model;
use crate::engine::part::{Part, square};
use crate::noise::measured::{KnownNoise, estimate_noise};
use crate::thresholds::fit::BASE_PASSES;

impl Prepared<'_> {
    /// Fits the base model; the noise is estimated anew where the start was far from it.
    pub(super) fn base_fit(
        &self,
        mut residual: Vec<Vec<f64>>,
        known: Option<&KnownNoise>,
    ) -> Result<BaseFit, DiagnosisError> {
        let mut values = self.problem.start();
        let mut pass = 0;
        loop {
            let (noise, scale) = match known {
                Some(known) => (known.noise.clone(), known.scale.clone()),
                None => estimate_noise(
                    &self.context,
                    &self.problem,
                    &residual,
                    &self.usable,
                    &self.own,
                    self.base.free.len(),
                ),
            };
            let blocks = Blocks::new(&self.context, &self.usable, &scale, &self.own, &noise);
            let derivatives = self.derivatives.as_ref();
            let whole = Part::new(&self.context, &self.problem, blocks, derivatives, self.base)?;
            let evaluate = |values: &[f64]| Ok(self.problem.evaluate(values, false)?.residual);
            let mut near = nearby(&whole, self.base, (values, residual), &evaluate)?;
            let is_near = near.convergence.was_successful();
            // where the calibration's own search found no minimum, another one leads away from what causes can mend
            if !is_near && self.base.unfinished.is_none() {
                near = self.far(&whole, near)?;
            }
            pass += 1;
            // a start far away has shown noise that is partly the way's
            if pass > 1 || is_near {
                return Ok(BaseFit {
                    noise,
                    scale,
                    whole,
                    values: near.values,
                    residual: near.residual,
                    promised: near.promised,
                    convergence: near.convergence,
                    last_step: near.last_step,
                });
            }
            (values, residual) = (near.values, near.residual);
        }
    }

    /// The minimum where the derivatives of the start do not lead to it; where it is as it was if there is none.
    fn far(&self, whole: &Part, near: Nearby) -> Result<Nearby, DiagnosisError> {
        let fitting = Fitting {
            context: &self.context,
            problem: &self.problem,
            base: self.base,
            effects: &[],
            part: whole,
        };
        let found = fitting.descend(&Model {
            values: near.values.clone(),
            bare: Arc::new(near.residual.clone()),
            causes: Vec::new(),
        })?;
        if !found.has_converged() {
            return Ok(near);
        }
        Ok(Nearby {
            values: found.model.values,
            residual: found.residual,
            promised: found.promised,
            convergence: found.convergence,
            last_step: found.last_step,
        })
    }
}

/// Outcome of [`nearby`].
pub(crate) struct Nearby {
    pub(crate) values: Vec<f64>,
    pub(crate) residual: Vec<Vec<f64>>,
    pub(crate) promised: f64,
    pub(crate) convergence: Convergence,
    /// Step that its end still asks for, in standard deviations of the residuals (root mean square).
    pub(crate) last_step: f64,
}

/// Residuals of the base model at its values, per stream and row.
type Evaluate<'e> = dyn Fn(&[f64]) -> Result<Vec<Vec<f64>>, DiagnosisError> + 'e;

/// The base model's minimum by Gauss-Newton with the derivatives of a part, from values and their residuals: a few steps with one
/// decomposition, as long as the cost falls.
pub(crate) fn nearby(
    part: &Part,
    base: &Base,
    (values, residual): (Vec<f64>, Vec<Vec<f64>>),
    evaluate: &Evaluate<'_>,
) -> Result<Nearby, DiagnosisError> {
    let rows = part.blocks.count() as f64;
    let freedom = (rows - base.free.len() as f64).max(1.0);
    let mut near = Nearby {
        values,
        residual,
        promised: 0.0,
        convergence: Convergence::IterationLimit,
        last_step: 0.0,
    };
    let mut cost = square(part, &near.residual, &base.pull(&near.values));
    for _ in 0..=BASE_PASSES {
        base.interrupt.check()?;
        let Some((step, promised)) = part.base_step(&near.residual, &base.pull(&near.values))?
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
        let mut next = near.values.clone();
        for (&parameter, change) in base.free.iter().zip(&step) {
            next[parameter] += change;
        }
        let Ok(rest) = evaluate(&next) else { break };
        let less = square(part, &rest, &base.pull(&next));
        if less.is_nan() || less >= cost {
            break;
        }
        (near.values, near.residual, cost) = (next, rest, less);
    }
    Ok(near)
}
