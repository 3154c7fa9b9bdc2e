//! A loop that turns over at each reversal within a travel (Dahl 1968): the shape is that travel.

use crate::laws::{Input, Law};
use crate::signal::dahl;

/// Dahl's loop of a joint's angle.
#[derive(Debug)]
pub(crate) struct Reversal;

impl Law for Reversal {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], shape: f64) -> Option<Vec<Vec<f64>>> {
        Some(vec![dahl(input.reading()?, shape, &input.context.runs)])
    }

    fn values(&self, _: Input<'_, '_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        vec![amplitudes[0].abs(), shape]
    }

    fn amplitudes(&self, _: Input<'_, '_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![values[0]], values[1])
    }
}
