//! Causes and models: what a refit starts from and ends with.

use std::sync::Arc;

use haptical_effects::{Context, Effect, Signal};
use haptical_identification::{Convergence, Matrix};

/// A cause with its fitted numbers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cause {
    /// Position in the catalogue.
    pub(crate) effect: usize,
    pub(crate) amplitudes: Vec<f64>,
    pub(crate) shape: f64,
    /// Of an event: one instant for each amplitude.
    pub(crate) times: Vec<f64>,
}

impl Cause {
    /// Derivatives with respect to its amplitudes.
    pub(crate) fn derivative(
        &self,
        effects: &[Box<dyn Effect>],
        context: &Context<'_>,
    ) -> Vec<Signal> {
        let effect = effects[self.effect].as_ref();
        if self.times.is_empty() {
            return effect.derivative(context, &self.amplitudes, self.shape);
        }
        self.times
            .iter()
            .flat_map(|&time| effect.derivative(context, &[0.0], time))
            .collect()
    }

    /// What it adds to the streams.
    pub(crate) fn contribution(
        &self,
        effects: &[Box<dyn Effect>],
        context: &Context<'_>,
    ) -> Signal {
        let effect = effects[self.effect].as_ref();
        self.summed(&|amplitudes, shape| effect.signal(context, amplitudes, shape))
    }

    /// The same as a device with it shows it, with the chain moved as far as it is.
    pub(crate) fn exact_contribution(
        &self,
        effects: &[Box<dyn Effect>],
        context: &Context<'_>,
    ) -> Signal {
        let effect = effects[self.effect].as_ref();
        self.summed(&|amplitudes, shape| effect.exact_signal(context, amplitudes, shape))
    }

    /// The signal of its amplitudes; of an event the sum of its steps.
    fn summed(&self, signal: &dyn Fn(&[f64], f64) -> Signal) -> Signal {
        if self.times.is_empty() {
            return signal(&self.amplitudes, self.shape);
        }
        let mut sum = Signal::default();
        for (&time, amplitude) in self.times.iter().zip(&self.amplitudes) {
            sum.add(&signal(&[*amplitude], time), 1.0);
        }
        sum
    }
}

/// Values of the base model's parameters with the causes found.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Model {
    pub(crate) values: Vec<f64>,
    /// Measured minus base model at these values, per stream and row of the recording fitted to.
    pub(crate) bare: Arc<Vec<Vec<f64>>>,
    pub(crate) causes: Vec<Cause>,
}

/// A fit of base model and causes together.
#[derive(Debug, Clone)]
pub(crate) struct Refit {
    pub(crate) model: Model,
    /// Measured minus model and causes, per stream and row.
    pub(crate) residual: Vec<Vec<f64>>,
    /// Covariance of all amplitudes (causes in order, each with its shape last where that is
    /// continuous), for noise of the estimated size.
    pub(crate) covariance: Option<Matrix>,
    /// Fall of the cost that the linearised problem still promises, in variances of the noise.
    pub(crate) promised: f64,
    /// Why the search stopped.
    pub(crate) convergence: Convergence,
    /// Step that its end still asks for, in standard deviations of the residuals (root mean square).
    pub(crate) last_step: f64,
}

impl Refit {
    /// Whether its numbers are those of a minimum.
    pub(crate) fn has_converged(&self) -> bool {
        self.convergence.was_successful()
    }

    /// By how much a search that was not stopped might still lower the cost.
    pub(crate) fn may_fall(&self) -> f64 {
        match self.has_converged() {
            true => 0.0,
            false => self.promised,
        }
    }
}
