//! Refits of base model and causes together.

use haptical_effects::Effect;

use crate::DiagnosisError;
use crate::engine::Engine;
use crate::engine::descent::Fitting;
use crate::engine::model::{Model, Refit};
use crate::engine::part::{Part, square};

impl Engine<'_> {
    /// Refits base model and causes together on all rows.
    pub(crate) fn refit(
        &self,
        effects: &[Box<dyn Effect>],
        model: &Model,
    ) -> Result<Refit, DiagnosisError> {
        self.refit_on(&self.whole, effects, model)
    }

    /// Refits base model and causes together from `model`; where that ends above the base model alone, from the
    /// base model with the causes at nothing, from where no step leads up.
    pub(crate) fn refit_on(
        &self,
        part: &Part,
        effects: &[Box<dyn Effect>],
        model: &Model,
    ) -> Result<Refit, DiagnosisError> {
        let fitting = Fitting {
            context: &self.context,
            problem: &self.problem,
            base: self.base,
            effects,
            part,
        };
        let fitted = fitting.descend(model)?;
        let cost = |refit: &Refit| self.cost_on(part, refit);
        let alone = &self.start;
        if model.causes.is_empty() || cost(&fitted) <= cost(alone) {
            return Ok(fitted);
        }
        let mut nothing = alone.model.clone();
        nothing.causes.clone_from(&model.causes);
        for cause in &mut nothing.causes {
            cause.amplitudes.fill(0.0);
        }
        let again = fitting.descend(&nothing)?;
        Ok(if cost(&again) < cost(&fitted) {
            again
        } else {
            fitted
        })
    }

    /// Squared residuals of a refit on all rows, and of its anchors.
    pub(crate) fn cost(&self, refit: &Refit) -> f64 {
        self.cost_on(&self.whole, refit)
    }

    fn cost_on(&self, part: &Part, refit: &Refit) -> f64 {
        square(part, &refit.residual, &self.base.pull(&refit.model.values))
    }
}
