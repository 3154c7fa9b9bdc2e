//! A part that yields by torque over stiffness, reported as the stiffness.

use crate::laws::{Input, Law};

/// -tau / k.
#[derive(Debug)]
pub(crate) struct Spring;

impl Law for Spring {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], _: f64) -> Option<Vec<Vec<f64>>> {
        let torque_nm = input.torque_nm()?.iter();
        Some(vec![torque_nm.map(|torque| -torque).collect()])
    }

    fn values(&self, _: Input<'_, '_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        vec![1.0 / amplitudes[0]]
    }

    fn amplitudes(&self, _: Input<'_, '_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![1.0 / values[0]], 0.0)
    }
}
