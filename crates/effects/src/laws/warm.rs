//! Laws of the warming since a reference temperature, which a device file states and a recording has as its mean.

use crate::laws::{Input, Law};
use crate::{Further, Signal};

/// Temperature at which nothing has grown.
pub(crate) const REFERENCE: Further = Further::needed("reference_degc");

/// A law that is linear in the warming, and has no other further number.
#[derive(Debug)]
pub(crate) struct Warm<L>(pub(crate) L);

impl<L: Law> Law for Warm<L> {
    fn columns(
        &self,
        input: Input<'_, '_>,
        amplitudes: &[f64],
        shape: f64,
    ) -> Option<Vec<Vec<f64>>> {
        self.0.columns(input, amplitudes, shape)
    }

    fn signals(&self, input: Input<'_, '_>, shape: f64) -> Option<Vec<Signal>> {
        self.0.signals(input, shape)
    }

    fn further(&self, input: Input<'_, '_>, _: &[f64], _: f64) -> Vec<f64> {
        vec![input.context.reference_degc]
    }
}
